#!/usr/bin/env python3
"""The page of `apothem view` in a real browser: known bodies in known colours at known places at two times, controls,
keys, addresses, a phone. Called with the program; APOTHEM_SCREENSHOTS names a folder that keeps the pictures."""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

from webdriver import Browser

FASTEST = (253, 231, 37)  # the last colour of Viridis
MATERIALS = [(230, 159, 0), (86, 180, 233)]  # the first two colours of Okabe and Ito
GREY = (204, 204, 204)
WHITE = (255, 255, 255)

# A block that moves along x at 1 m/s, one that turns about its middle, an L that falls, a mesh at rest.
SCENE = {
    "name": "four <bodies>",
    "gravity": [0, -10],
    "materials": {"ice": {"density": 900, "young": 1e7, "poisson": 0.3}, "rock": {"density": 2000}},
    "contact": {"normal_stiffness": 1e7},
    "bodies": [
        {"name": "moving", "material": "rock", "polygon": [[0, 0], [1, 0], [1, 1], [0, 1]],
         "motion": {"velocity": [[0, 1, 0]]}},
        {"name": "turning", "material": "rock", "polygon": [[5, 0], [7, 0], [7, 0.4], [5, 0.4]],
         "motion": {"spin": [[0, 1.5707963267948966]]}},
        {"name": "falling", "material": "ice", "polygon": [[0, 8], [2, 8], [2, 8.5], [0.5, 8.5], [0.5, 10], [0, 10]]},
        {"name": "sheet", "material": "ice", "mesh": {"rectangle": {"size": [2, 1], "cells": [4, 2], "origin": [4, 8]}},
         "supports": [{"where": {"y": 8}, "fix": ["x", "y"]}, {"where": {"y": 9}, "fix": ["x", "y"]}]},
        {"name": "fixed", "material": "rock", "motion": "fixed", "polygon": [[7, 6], [8, 6], [8, 7], [7, 7]]},
    ],
    "regions": {"bin": {"polygon": [[0, 0], [8, 0], [8, 10], [0, 10]]}},
    "time": {"end": 1, "step": 1e-3},
    "output": {"frames": 10, "history": {"interval": 0.01}},
}


# A block of 40 kN at rest on a floor.
LOADED = {
    "name": "loaded",
    "gravity": [0, -10],
    "materials": {"rock": {"density": 2000}},
    "contact": {"normal_stiffness": 1e8},
    "bodies": [
        {"name": "floor", "material": "rock", "motion": "fixed", "polygon": [[0, 0], [4, 0], [4, 1], [0, 1]]},
        {"name": "block", "material": "rock", "polygon": [[1, 1], [3, 1], [3, 2], [1, 2]]},
    ],
    "time": {"end": 0.1, "start": "settled"},
    "output": {"frames": 2},
}


class Checks:
    def __init__(self, browser, folder):
        self.browser, self.folder, self.number = browser, folder, 0

    def that(self, holds, message):
        if not holds:
            raise AssertionError(message)

    def equal(self, found, expected, what):
        self.that(found == expected, f"{what}: {found!r} in place of {expected!r}")

    def picture(self, name):
        return self.browser.picture(os.path.join(self.folder, name + ".png") if self.folder else None)

    def place(self, x, y, pixels=1):
        """Where a point of the scene is in the screenshot."""
        return [pixels * v for v in self.browser.evaluate(
            f"(() => {{ const b = document.getElementById('bodies').getBoundingClientRect(), o = player.run.origin,"
            f" p = player.view.toScreen({x} - o[0], {y} - o[1]); return [b.left + p[0], b.top + p[1]]; }})()")]

    def colour(self, picture, x, y, expected, pixels=1):
        found = picture.at(*self.place(x, y, pixels))
        self.that(all(abs(a - b) <= 4 for a, b in zip(found, expected)), f"colour {found} at ({x}, {y}) in place of {expected}")


def wait_for_run(browser):
    browser.wait("window.player !== undefined || document.getElementById('message').textContent.includes('cannot')")


def at_two_times(check, page):
    browser, (ice, rock) = check.browser, MATERIALS
    browser.open(page + "#t=0&colour=material")
    wait_for_run(browser)
    check.equal(browser.evaluate("document.title"), "four <bodies>", "title")
    check.equal(browser.evaluate("performance.getEntriesByType('resource').length"), 0, "loaded resources")
    start = check.picture("desktop-start")
    check.colour(start, 0.2, 0.5, rock)       # the moving block
    check.colour(start, 1.2, 0.5, WHITE)
    check.colour(start, 5.3, 0.2, rock)       # the turning one lies
    check.colour(start, 6.0, -0.5, WHITE)
    check.colour(start, 0.25, 9.5, ice)       # the L with its corner that is outside
    check.colour(start, 1.3, 9.3, WHITE)
    check.colour(start, 5.3, 8.3, ice)        # an element of the mesh
    browser.open(page + "#t=1&colour=material")
    wait_for_run(browser)
    end = check.picture("desktop-end")
    check.colour(end, 0.2, 0.5, WHITE)
    check.colour(end, 1.2, 0.5, rock)
    check.colour(end, 5.3, 0.2, WHITE)        # it stands
    check.colour(end, 6.0, -0.5, rock)
    check.colour(end, 0.25, 4.5, ice)         # the L has fallen by 5 m
    check.colour(end, 1.3, 4.3, WHITE)
    check.colour(end, 0.25, 9.5, WHITE)
    check.colour(end, 5.3, 8.3, ice)
    # By speed: the L is the fastest, with 10 m/s, and the scale holds for all frames.
    browser.open(page + "#t=1&colour=speed")
    wait_for_run(browser)
    speed = check.picture("desktop-speed")
    check.colour(speed, 0.25, 4.5, FASTEST)
    check.colour(speed, 7.2, 6.5, GREY)  # fixed bodies have no colour of a quantity
    check.that(browser.evaluate("Math.abs(player.quantity.high - 10) < 0.02"), "the scale does not end at 10 m/s")


def controls(check, page):
    browser = check.browser
    browser.open(page)
    wait_for_run(browser)
    frame = lambda: browser.evaluate("player.frame")
    check.equal(frame(), 0, "first frame")
    browser.keys("\ue014\ue014\ue012")  # right, right, left
    check.equal(frame(), 1, "frame after the arrows")
    check.equal(browser.evaluate("location.hash.startsWith('#t=0.1&')"), True, "address after the arrows")
    before = browser.evaluate("player.drawn.count")
    # So slow that a busy machine has the time to draw some of the frames.
    browser.evaluate("(() => { const speed = document.getElementById('speed'); speed.value = 2;"
                     " speed.dispatchEvent(new Event('change')); })()")
    browser.keys(" ")
    browser.wait("!player.playing && player.frame === 10")
    check.that(browser.evaluate("player.drawn.count") >= before + 3, "it jumped to the end")
    browser.keys("\ue011c")  # home; the next colour
    check.equal(browser.evaluate("player.quantity.name"), browser.evaluate("player.run.quantities[1].name"), "next colour")
    # A tap on the moving block, which says where it is.
    x, y = check.place(0.5, 0.5)
    browser.tap(x, y)
    check.equal(browser.evaluate("document.getElementById('body-name').textContent"), "moving", "tapped body")
    numbers = "[...document.querySelectorAll('#body-numbers td')].map(cell => cell.textContent)"
    check.that("0.5 m" in browser.evaluate(numbers), "its x is not in the table")
    browser.keys("\ue010")  # end
    check.that("1.5 m" in browser.evaluate(numbers), "its x at the end is not in the table")
    check.picture("desktop-body")
    # A tap on the ledger of energy goes to that time.
    box = browser.evaluate("(() => { const c = player.plots[0].canvas; c.scrollIntoView(); const b = c.getBoundingClientRect();"
                           " return [b.left, b.top, b.width, b.height, player.plots[0].left, player.plots[0].right]; })()")
    browser.tap(box[0] + box[4] + 0.5 * (box[2] - box[4] - box[5]), box[1] + box[3] / 2)
    check.equal(frame(), 5, "frame after a tap on a plot")
    # Zoom, then everything again.
    before = browser.evaluate("player.view.scale")
    browser.keys("+")
    check.that(browser.evaluate("player.view.scale") > 1.4 * before, "the key + does not zoom")
    browser.keys("0")
    check.equal(browser.evaluate("player.view.scale"), before, "scale of the whole")


def chains(check, page):
    browser = check.browser
    browser.open(page)
    wait_for_run(browser)
    scale = "document.getElementById('chain-scale')"
    check.equal(browser.evaluate(scale + ".hidden"), True, "scale of chains that are not shown")
    browser.keys("k")
    text = browser.evaluate(scale + ".textContent")
    check.that("normal force of a contact: 40 kN" in text, f"the scale of the weight of the block says {text!r}")
    # From the middle of the block to that of its lower side; 4 pixels wide, as the sample.
    picture, line = check.picture("desktop-chains"), (166, 13, 26)
    check.equal(browser.evaluate(scale + ".querySelector('i').getBoundingClientRect().height"), 4, "width of the sample")
    check.colour(picture, 2, 1.3, line)
    x, y = check.place(2, 1.3)
    width = sum(picture.at(x + i, y) == picture.at(x, y) for i in range(-20, 21))
    check.that(3 <= width <= 5, f"the line is {width} pixels wide")


def phone(check, page):
    browser = check.browser
    browser.open(page + "#t=0&colour=material&body=sheet")
    wait_for_run(browser)
    picture = check.picture("phone")
    check.equal((picture.width, picture.height), (780, 1688), "pixels of the phone")
    check.equal(browser.evaluate("document.documentElement.scrollWidth"), 390, "width of the page")
    check.colour(picture, 0.5, 0.5, MATERIALS[1], 2)
    order = browser.evaluate("['stage', 'controls', 'body', 'plots'].map(id =>"
                             " { const b = document.getElementById(id).getBoundingClientRect(); return [b.top, b.left, b.right]; })")
    check.that(order == sorted(order) and all(b[1] >= 0 and b[2] <= 390 for b in order), f"not below each other: {order}")
    small = browser.evaluate("[...document.querySelectorAll('#controls button, #controls select')].filter(b =>"
                             " b.getBoundingClientRect().height < 32).length")
    check.equal(small, 0, "buttons that are too small for fingers")
    centre, scale = browser.evaluate("[player.view.centre, player.view.scale]")
    browser.fingers([(200, 200)], [(230, 200)], [(260, 200)])
    moved = browser.evaluate("player.view.centre")
    check.that(abs((centre[0] - moved[0]) * scale - 60) < 1.5, "a finger does not move the picture")
    browser.fingers([(150, 200), (250, 200)], [(125, 200), (275, 200)], [(100, 200), (300, 200)])
    check.that(abs(browser.evaluate("player.view.scale") / scale - 2) < 0.05, "two fingers do not zoom")
    browser.evaluate("window.scrollTo(0, document.getElementById('plots').offsetTop)")
    check.picture("phone-plots")


def main():
    program, screenshots = os.path.abspath(sys.argv[1]), os.environ.get("APOTHEM_SCREENSHOTS", "")
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder, "scene.json")
        scene.write_text(json.dumps(SCENE))
        subprocess.run([program, "run", scene, "-o", folder + "/run", "--quiet"], check=True)
        subprocess.run([program, "view", folder + "/run", "-o", folder + "/page.html"], check=True)
        page = pathlib.Path(folder, "page.html").as_uri()
        scene.write_text(json.dumps(LOADED))
        subprocess.run([program, "run", scene, "-o", folder + "/loaded", "--quiet"], check=True)
        subprocess.run([program, "view", folder + "/loaded", "-o", folder + "/loaded.html"], check=True)
        loaded = pathlib.Path(folder, "loaded.html").as_uri()
        for width, height, parts in [(1280, 800, [at_two_times, controls, lambda check, _: chains(check, loaded)]),
                                     (390, 844, [phone])]:
            with Browser(width, height, phone=width < 500) as browser:
                check = Checks(browser, screenshots)
                for part in parts:
                    part(check, page)
                check.equal(browser.console(), [], "messages on the console")
                print(f"{width} x {height}: as expected")


main()
