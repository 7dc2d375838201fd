"""What a program runs: App and its loop, a window, one picture."""
