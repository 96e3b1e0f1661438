"""Values as messages and pages say them."""


def plain(value: float, digits: int = 2) -> str:
    """A number with so many digits, without an exponent below a million."""
    return f"{float(f'{value:.{digits}g}'):g}"


def rounded(value: object, digits: int = 10) -> object:
    """Numbers, also in lists and tables, without the noise of computed ones: 24.1 for 24.099999999999998."""
    if isinstance(value, list):
        return [rounded(each, digits) for each in value]
    if isinstance(value, dict):
        return {key: rounded(each, digits) for key, each in value.items()}
    return float(f"{value:.{digits}g}") if isinstance(value, float) else value


def counted(count: float, what: str) -> str:
    """How many there are of what is named in the singular; also 1.5."""
    number = f"{count:g}" if isinstance(count, float) else count
    return f"{number} {what}{'' if count == 1 else 's'}"


def shown(value: object) -> str:
    """One-line text of a refused value, cut where it is long."""
    try:
        text = repr(value).replace("\n", " ")
    except (ValueError, RecursionError):  # an integer of thousands of digits, a table as deep
        text = f"a {type(value).__name__} too large to be shown"
    return text if len(text) <= 60 else text[:57] + "..."
