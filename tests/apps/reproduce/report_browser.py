#!/usr/bin/env python3
"""The report of `apothem reproduce` in a real browser without a network: on a desktop, on a phone and on paper nothing is
cut off, pictures are there, and tables are tables where there is room. Called with the program; APOTHEM_SCREENSHOTS names a
folder that keeps pictures of each figure and the printed pages."""

import base64
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "player"))
from webdriver import Browser  # noqa: E402

FIGURES = ["fig-4", "fig-14", "fig-17", "fig-26"]
SCREENS = ((1280, False), (1100, False), (900, False), (400, True))
TOO_WIDE = ("Array.from(document.querySelectorAll('body *')).filter(e => !e.closest('.picture, .numbers') && "
            "e.getBoundingClientRect().right > document.documentElement.clientWidth + 1).map(e => e.tagName + ' ' + "
            "e.textContent.slice(0, 40)).join('; ')")
# Tables that have to be scrolled.
SCROLLED = ("Array.from(document.querySelectorAll('.numbers')).filter(e => e.scrollWidth > e.clientWidth + 1).map(e => "
            "e.previousElementSibling.textContent).join('; ')")
# Words of numbers and units that a line breaks in: their text has more than one rectangle.
BROKEN = ("Array.from(document.querySelectorAll('td.number')).filter(e => { const r = document.createRange(); "
          "r.selectNodeContents(e); return new Set(Array.from(r.getClientRects()).map(b => b.top)).size > 1; }).length")


# Cells of rows that became lists, in which the head lies on the text.
OVERLAPPING = ("Array.from(document.querySelectorAll('td')).filter(e => { const r = document.createRange(); "
               "r.selectNodeContents(e); const head = parseFloat(getComputedStyle(e, '::before').width); return r.toString() && "
               "r.getBoundingClientRect().left < e.getBoundingClientRect().left + head; }).map(e => e.dataset.head).join('; ')")


def keep(name, png):
    folder = os.environ.get("APOTHEM_SCREENSHOTS")
    if folder:
        (pathlib.Path(folder) / name).write_bytes(base64.b64decode(png))


class Checks:
    def __init__(self, browser, where):
        self.browser, self.where, self.failed = browser, where, 0

    def equal(self, expression, expected, what):
        value = self.browser.evaluate(expression)
        if value != expected:
            print(f"{self.where}: {what}: {value!r} in place of {expected!r}")
            self.failed += 1


def look(report, width, phone):
    with Browser(width, 900, phone=phone) as browser:
        browser.cdp("Network.enable")
        browser.cdp("Network.emulateNetworkConditions", offline=True, latency=0, downloadThroughput=0, uploadThroughput=0)
        browser.open(report.as_uri())
        browser.wait("Array.from(document.images).every(i => i.complete)")
        check = Checks(browser, f"{width} px")
        if phone:
            # Folded, the page is a few screens for each figure.
            check.equal(f"document.documentElement.scrollHeight < {900 * (3 + 4 * len(FIGURES))}", True, "the length when folded")
        check.equal("document.querySelectorAll('details').length >= " + str(2 * len(FIGURES)), True, "parts that unfold")
        check.equal("Array.from(document.querySelectorAll('details')).filter(d => d.open !== "
                    "!!d.querySelector('tr.missed')).length", 0, "what is unfolded: missed numbers alone")
        check.equal("document.body.textContent.includes('" + str(report.parent) + "')", False, "paths of this machine")
        browser.evaluate("document.querySelectorAll('details').forEach(d => d.open = true)")
        check.equal("document.querySelectorAll('h2').length >= " + str(len(FIGURES) + 1), True, "headings")
        check.equal("document.images.length", len(FIGURES), "pictures")
        check.equal("Array.from(document.images).filter(i => !i.naturalWidth || !i.alt).length", 0,
                    "pictures without pixels or text")
        check.equal("document.documentElement.scrollWidth <= innerWidth", True, "the page fits")
        check.equal(TOO_WIDE, "", "what is cut off")
        check.equal(BROKEN, 0, "numbers that are broken")
        if width != 900:  # tables may scroll between a phone and a desktop
            check.equal(SCROLLED, "", "tables that scroll")
        if phone:
            check.equal(OVERLAPPING, "", "heads on the text of their cells")
        check.equal("getComputedStyle(document.querySelector('td')).display", "block" if phone else "table-cell", "cells")
        check.equal("Array.from(document.querySelectorAll('a[href^=\"#\"]')).filter(a => "
                    "!document.getElementById(a.getAttribute('href').slice(1))).length", 0, "links to nowhere")
        if browser.console():
            print(f"{width} px: the console says {browser.console()}")
            check.failed += 1
        for name in FIGURES:
            top = browser.evaluate(f"document.getElementById('{name}').getBoundingClientRect().top + scrollY")
            keep(f"{name}-{width}.png", browser.cdp("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip={
                "x": 0, "y": top, "width": width, "height": 3000, "scale": 1})["data"])
        if width == 1280:  # a page of paper is narrower than the screens on which rows become lists
            browser.cdp("Emulation.setEmulatedMedia", media="print")
            browser.cdp("Emulation.setDeviceMetricsOverride", width=760, height=1000, deviceScaleFactor=1, mobile=False)
            check.where = "paper"
            check.equal("getComputedStyle(document.querySelector('td')).display", "table-cell", "cells")
            check.equal(SCROLLED, "", "tables that are cut off")
            check.equal(TOO_WIDE, "", "what is cut off")
            keep("report.pdf", browser.cdp("Page.printToPDF", paperWidth=8.27, paperHeight=11.69)["data"])
        return check.failed


def main():
    with tempfile.TemporaryDirectory() as folder:
        out = pathlib.Path(folder).resolve()
        subprocess.run([sys.argv[1], "reproduce", *FIGURES, "-o", str(out)], check=True, stdout=subprocess.DEVNULL)
        failed = sum(look(out / "report.html", width, phone) for width, phone in SCREENS)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
