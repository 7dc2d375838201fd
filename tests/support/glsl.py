"""What a compiler sees of GLSL, without a compiler."""

import re

__all__ = ["preprocessed"]


def preprocessed(text: str) -> str:
    """The lines whose conditions hold, without comments."""
    names = dict(re.findall(r"#define (\w+) ?(.*)", text))
    kept: list[str] = []
    # Of each condition around a line: whether this branch is taken, and
    # whether one before it was.
    stack: list[tuple[bool, bool]] = []
    for line in text.splitlines():
        word = line.strip().split("//")[0].strip()
        match = re.match(r"#\s*(ifdef|ifndef|if|elif|else|endif)\b(.*)", word)
        if match is None:
            taken = all(branch for branch, _ in stack)
            if taken and word and not word.startswith("#"):
                kept.append(word)
            continue
        kind, condition = match[1], match[2].strip()
        if kind in ("ifdef", "ifndef"):
            stack.append(((condition in names) == (kind == "ifdef"), False))
        elif kind == "if":
            stack.append((_holds(condition, names), False))
        elif kind in ("elif", "else"):
            done = any(stack.pop())
            holds = kind == "else" or _holds(condition, names)
            stack.append((holds and not done, done))
        else:
            stack.pop()
    return "\n".join(kept)


def _holds(condition: str, names: dict[str, str]) -> bool:
    text = re.sub(
        r"defined\s*\(?\s*(\w+)\s*\)?",
        lambda match: str(match[1] in names),
        condition,
    )
    text = re.sub(r"\bMOKA_\w+", lambda match: names.get(match[0]) or "0", text)
    text = text.replace("||", " or ").replace("&&", " and ")
    return bool(eval(text.replace("!", " not "), {"__builtins__": {}}))
