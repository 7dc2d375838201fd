"""What every room of the house uses: errors, maths, colour, image files."""
