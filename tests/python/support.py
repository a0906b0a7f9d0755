"""Shared by the tests of the Python module."""
import os
import pathlib
import tempfile
import unittest

SOURCE = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["APOTHEM_PROGRAM"]


def square(x, y, size):
    return [[x, y], [x + size, y], [x + size, y + size], [x, y + size]]


def falling_block(**others):
    """A block that falls on a plate, with friction."""
    return {
        "name": "block",
        "gravity": [0, -9.81],
        "materials": {"rock": {"density": 2000}},
        "contact": {"normal_stiffness": 1e7,
                    "friction": {"coefficient": 0.3, "tangential_stiffness": 5e6}},
        "bodies": [{"name": "plate", "material": "rock", "motion": "fixed",
                    "polygon": [[-5, -1], [5, -1], [5, 0], [-5, 0]]},
                   {"name": "block", "material": "rock", "polygon": square(0, 0.05, 1),
                    "velocity": [1, 0], "spin": 0.2}],
        "time": {"end": 0.3, "step": 1e-4},
        **others,
    }


def flying_block(**others):
    """A block that touches nothing."""
    return {
        "materials": {"rock": {"density": 2000}},
        "bodies": [{"name": "block", "material": "rock", "polygon": square(0, 0, 1)}],
        "time": {"end": 1, "step": 1e-3},
        **others,
    }


def beam():
    """A beam of finite elements that is clamped on its left."""
    return {
        "gravity": [0, -9.81],
        "materials": {"steel": {"density": 7800, "young": 2e9, "poisson": 0.3, "plane": "stress"}},
        "bodies": [{"name": "beam", "material": "steel",
                    "mesh": {"rectangle": {"size": [4, 1], "cells": [8, 2]}, "element": "Q4"},
                    "supports": [{"where": {"x": 0}, "fix": ["x", "y"]}]}],
        "time": {"end": 0.02},
    }


class FolderCase(unittest.TestCase):
    """A test with a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
