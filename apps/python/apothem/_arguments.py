"""Arguments that a function does not take, in words: pybind11 lists C++ types and prints what it was given in full."""

import functools
import re


def _plain(message, name, args, kwargs):
    ways = re.findall(r"^    \d+\. (.*?)(?: -> .*)?$", message, re.MULTILINE)
    ways = [way[way.index("("):] for way in ways if "(" in way]
    for cpp, python in ((r"apothem\._apothem\.", ""), (r"numpy\.ndarray\[[^]]*\]", "array of numbers"),
                        (r"\(self: \w+(, )?", "(")):
        ways = [re.sub(cpp, python, way) for way in ways]
    given = [type(value).__name__ for value in args]
    given += [f"{key}={type(value).__name__}" for key, value in kwargs.items()]
    return f"{name} takes " + " or ".join(ways) + f", not ({', '.join(given)})"


def _in_words(function, name, bound):
    @functools.wraps(function)
    def call(*args, **kwargs):
        try:
            return function(*args, **kwargs)
        except TypeError as error:
            message = str(error)
            if "The following argument types are supported" not in message:
                raise
        raise TypeError(_plain(message, name, args[bound:], kwargs))
    return call


def explain_arguments(*things):
    """Functions in the form in which they say what they take; classes are changed themselves."""
    results = []
    for thing in things:
        if not isinstance(thing, type):
            results.append(_in_words(thing, thing.__name__, 0))
            continue
        for key, value in list(vars(thing).items()):
            if type(value).__name__ == "instancemethod" and (key == "__init__" or not key.startswith("_")):
                name = thing.__name__ if key == "__init__" else f"{thing.__name__}.{key}"
                setattr(thing, key, _in_words(value, name, 1))
    return results
