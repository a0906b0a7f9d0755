"""Numbers as documents state them: their digits, what agrees with them, and how a fresh one is written."""
import math
import re

NUMBER = re.compile(
    r"(?<![\w.^#/])([-+]?(?:\d{1,3}(?: \d{3})+(?:\.\d+)?(?![\d.])|\d+\.\d+|\d+|\.\d+)(?:e[-+]?\d+)?)(k|M)?(?![\w])")
RANGE = re.compile(f"{NUMBER.pattern}(?: to {NUMBER.pattern})?")


class Problem(Exception):
    """What makes an entry wrong, whatever a fresh run prints."""


def number(text):
    match = NUMBER.search(text)
    if not match:
        raise Problem(f"'{text}' is no number")
    return value_of(match)


def value_of(match):
    digits = match.group(1).replace(" ", "")
    scale = {None: 1.0, "k": 1e3, "M": 1e6}[match.group(2)]
    mantissa, _, exponent = digits.partition("e")
    places = len(mantissa.partition(".")[2])
    unit = 10.0 ** (int(exponent or 0) - places)
    if "." not in mantissa and not exponent and match.group(2) is None:
        zeros = len(mantissa) - len(mantissa.rstrip("0"))
        unit = 10.0 ** min(zeros, max(0, len(mantissa.lstrip("+-")) - 2))
    return float(digits) * scale, unit * scale


def agrees(stated, now, within):
    """Whether a fresh number, or (least, largest), is what the document states."""
    low, high = now if isinstance(now, (tuple, list)) else (now, now)
    if not (math.isfinite(low) and math.isfinite(high)):
        return False
    if stated.strip().startswith("<") or (within or "").startswith("below"):
        value, unit = number(stated)
        factor = float(within.split(" x")[1]) if " x" in (within or "") else 1
        return high <= factor * value + unit / 2
    ends = [number(end) for end in stated.split(" to ")]
    least, largest = ends[0][0], ends[-1][0]
    if within is None:
        slack = 1.0001 * max(unit for _, unit in ends)
    elif within.endswith("%"):
        slack = float(within[:-1]) / 100 * max(abs(least), abs(largest))
    elif within.startswith("x"):
        factor = float(within[1:])
        return low <= largest * factor and high >= least / factor
    else:
        slack = float(within)
    return low <= largest + slack and high >= least - slack


def written(value, like):
    """A number in the form of another one: as many significant digits, the same unit, blanks and exponent."""
    match = NUMBER.search(like)
    digits, suffix = match.group(1), match.group(2) or ""
    mantissa, _, exponent = digits.replace(" ", "").lstrip("+-").partition("e")
    value /= {"": 1.0, "k": 1e3, "M": 1e6}[suffix]
    places = max(1, len(mantissa.replace(".", "").lstrip("0")))
    if exponent:
        shown, power = f"{value:.{places - 1}e}".split("e")
        return f"{shown}e{int(power)}{suffix}"
    if value == 0:
        return "0" + suffix
    exact = float(f"{value:.{places - 1}e}")
    decimals = max(0, places - 1 - math.floor(math.log10(abs(exact))))
    blank = "" if 4 <= len(mantissa) < 5 and " " not in digits else " "
    shown = f"{exact:,.{decimals}f}".replace(",", blank)
    if digits.lstrip("+-").startswith("."):
        shown = shown.replace("0.", ".", 1)
    return shown + suffix


def restated(stated, now):
    """What a document should state in place of `stated`: a number, a range or a bound."""
    low, high = now if isinstance(now, (tuple, list)) else (now, now)
    if stated.strip().startswith("<"):
        power = math.floor(math.log10(high)) if high > 0 else -300
        bound = math.ceil(high / 10.0 ** power) * 10.0 ** power
        return f"< {written(bound, stated)}"
    ends = stated.split(" to ")
    if len(ends) == 1:
        return written((low + high) / 2, stated)
    return f"{written(low, ends[0])} to {written(high, ends[1])}"
