"""Keys, mouse buttons and modifiers, whatever library reports them.

A key is a place on the keyboard, named after what a US layout prints there;
what a press means as text is a :class:`~moka.app.events.TextEvent`.
"""

from enum import Enum, IntFlag

__all__ = [
    "GamepadAxis",
    "GamepadButton",
    "Key",
    "Modifiers",
    "MouseButton",
]


class MouseButton(Enum):
    """A button of the mouse; 4 to 8 are further ones that it may have."""

    LEFT = 1
    RIGHT = 2
    MIDDLE = 3
    BUTTON_4 = 4
    BUTTON_5 = 5
    BUTTON_6 = 6
    BUTTON_7 = 7
    BUTTON_8 = 8


class GamepadButton(Enum):
    """A button of a gamepad, by its place and not by what is printed on it."""

    SOUTH = 0
    EAST = 1
    WEST = 2
    NORTH = 3
    LEFT_BUMPER = 4
    RIGHT_BUMPER = 5
    BACK = 6
    START = 7
    GUIDE = 8
    LEFT_STICK = 9
    RIGHT_STICK = 10
    UP = 11
    RIGHT = 12
    DOWN = 13
    LEFT = 14


class GamepadAxis(Enum):
    """An axis of a gamepad."""

    LEFT_X = 0
    LEFT_Y = 1
    RIGHT_X = 2
    RIGHT_Y = 3
    LEFT_TRIGGER = 4
    RIGHT_TRIGGER = 5


class Modifiers(IntFlag):
    """Modifier keys that are held; SUPER is Windows or Command."""

    NONE = 0
    SHIFT = 1
    CONTROL = 2
    ALT = 4
    SUPER = 8


class Key(Enum):
    """A key of the keyboard."""

    UNKNOWN = "unknown"

    A = "a"
    B = "b"
    C = "c"
    D = "d"
    E = "e"
    F = "f"
    G = "g"
    H = "h"
    I = "i"  # noqa: E741
    J = "j"
    K = "k"
    L = "l"
    M = "m"
    N = "n"
    O = "o"  # noqa: E741
    P = "p"
    Q = "q"
    R = "r"
    S = "s"
    T = "t"
    U = "u"
    V = "v"
    W = "w"
    X = "x"
    Y = "y"
    Z = "z"
    DIGIT_0 = "0"
    DIGIT_1 = "1"
    DIGIT_2 = "2"
    DIGIT_3 = "3"
    DIGIT_4 = "4"
    DIGIT_5 = "5"
    DIGIT_6 = "6"
    DIGIT_7 = "7"
    DIGIT_8 = "8"
    DIGIT_9 = "9"
    SPACE = "space"
    APOSTROPHE = "apostrophe"
    COMMA = "comma"
    MINUS = "minus"
    PERIOD = "period"
    SLASH = "slash"
    SEMICOLON = "semicolon"
    EQUAL = "equal"
    LEFT_BRACKET = "left_bracket"
    BACKSLASH = "backslash"
    RIGHT_BRACKET = "right_bracket"
    GRAVE_ACCENT = "grave_accent"
    WORLD_1 = "world_1"
    WORLD_2 = "world_2"
    ESCAPE = "escape"
    ENTER = "enter"
    TAB = "tab"
    BACKSPACE = "backspace"
    INSERT = "insert"
    DELETE = "delete"
    RIGHT = "right"
    LEFT = "left"
    DOWN = "down"
    UP = "up"
    PAGE_UP = "page_up"
    PAGE_DOWN = "page_down"
    HOME = "home"
    END = "end"
    CAPS_LOCK = "caps_lock"
    SCROLL_LOCK = "scroll_lock"
    NUM_LOCK = "num_lock"
    PRINT_SCREEN = "print_screen"
    PAUSE = "pause"
    MENU = "menu"
    F1 = "f1"
    F2 = "f2"
    F3 = "f3"
    F4 = "f4"
    F5 = "f5"
    F6 = "f6"
    F7 = "f7"
    F8 = "f8"
    F9 = "f9"
    F10 = "f10"
    F11 = "f11"
    F12 = "f12"
    F13 = "f13"
    F14 = "f14"
    F15 = "f15"
    F16 = "f16"
    F17 = "f17"
    F18 = "f18"
    F19 = "f19"
    F20 = "f20"
    F21 = "f21"
    F22 = "f22"
    F23 = "f23"
    F24 = "f24"
    F25 = "f25"
    KEYPAD_0 = "keypad_0"
    KEYPAD_1 = "keypad_1"
    KEYPAD_2 = "keypad_2"
    KEYPAD_3 = "keypad_3"
    KEYPAD_4 = "keypad_4"
    KEYPAD_5 = "keypad_5"
    KEYPAD_6 = "keypad_6"
    KEYPAD_7 = "keypad_7"
    KEYPAD_8 = "keypad_8"
    KEYPAD_9 = "keypad_9"
    KEYPAD_DECIMAL = "keypad_decimal"
    KEYPAD_DIVIDE = "keypad_divide"
    KEYPAD_MULTIPLY = "keypad_multiply"
    KEYPAD_SUBTRACT = "keypad_subtract"
    KEYPAD_ADD = "keypad_add"
    KEYPAD_ENTER = "keypad_enter"
    KEYPAD_EQUAL = "keypad_equal"
    LEFT_SHIFT = "left_shift"
    LEFT_CONTROL = "left_control"
    LEFT_ALT = "left_alt"
    LEFT_SUPER = "left_super"
    RIGHT_SHIFT = "right_shift"
    RIGHT_CONTROL = "right_control"
    RIGHT_ALT = "right_alt"
    RIGHT_SUPER = "right_super"
