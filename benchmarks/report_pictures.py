"""Makes the pictures of docs/gallery.md: reports on simulated and on real drives, as a browser shows them.

    python benchmarks/report_pictures.py [--only gallery_emps]

The pages are made into build/pages, unless they are there; the pictures go to docs/pictures, and what each page answers
is quoted in docs/gallery.md. Needs Chromium, and for the real drives the folder of real measurements beside the
project. Measured data goes nowhere but into the pages.
"""

from __future__ import annotations

import argparse
import io
import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parent.parent
DATA = ROOT.parent / "shared" / "data"
PAGES = ROOT / "build" / "pages"
PICTURES = ROOT / "docs" / "pictures"
COLOURS = 128
"""Of a picture with a palette: text stays sharp, and a page takes a fifth of the bytes."""
MOST_BYTES = 200_000
GALLERY = ROOT / "docs" / "gallery.md"
QUOTED = r"(<!-- answer: {name} -->\n).*?(<!-- end -->)"
MOTOR = """\
inertia: 4.87e-6
friction: {viscous: 1.0e-4, coulomb: 1.0e-2}
effects:
  - {name: gravity, sine: 0.003}
excitation: {kind: tracking, velocity: 20, frequency: 0.5, bandwidth: 20}
sensors: {velocity_noise_percent: 0.1}
rate: 1000
samples: 8000
"""


@dataclass(frozen=True)
class Shot:
    """A picture of a page.

    Attributes:
        name: of the picture.
        page: that it is taken of.
        figure: id of a figure; the top of the page if empty.
        section: id of a section, from which the window is shown.
        width, height: of the window, in pixels; the height is that of the figure where one is named.
        scheme: light or dark.
    """

    name: str
    page: str
    figure: str = ""
    section: str = ""
    width: int = 1280
    height: int = 1360
    scheme: str = "light"


SHOTS = (
    Shot("gallery_motor", "motor"),
    Shot("gallery_demo", "demo", scheme="dark"),
    Shot("gallery_demo_estimates", "demo_tournament", "history-ekf"),
    Shot("gallery_emps", "emps"),
    Shot("gallery_emps_motion", "emps_position", "simulated-motion"),
    Shot("gallery_laas", "laas"),
    Shot("gallery_tiago", "tiago"),
    Shot("gallery_tiago_phone", "tiago", width=400, height=1500),
    Shot("report_verdict", "demo", width=1180, height=1090),
    Shot("report_against_measurement", "demo", section="measured", width=1180, height=900, scheme="dark"),
    Shot("report_limits", "demo", section="limits", width=1180, height=760),
    Shot("report_phone", "demo", width=400, height=860),
    Shot("report_tournament", "tournament", width=1180, height=900),
)
"""Of the gallery, and of the page on reports."""


def fricmodels(*arguments: str | Path, where: Path = PAGES) -> None:
    """Run a command in a folder, so that pages name files as they lie in it; what it prints is not shown."""
    command = [sys.executable, "-m", "fricmodels", *map(str, arguments)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, cwd=where)


def columns(**given: str) -> list[str]:
    """Return the options that map columns."""
    return [part for channel, column in given.items() for part in ("--column", f"{channel}={column}")]


def make(page: str) -> Path:
    """Return the report of a drive, made if it is not there."""
    file = PAGES / f"{page}.html"
    if file.exists():
        return file
    PAGES.mkdir(parents=True, exist_ok=True)
    print(f"making {file.relative_to(ROOT)}", flush=True)
    report = ["--model", "coulomb-viscous", "--out", file]
    emps = columns(time="t:s", force="force_N:N", position="pos_m:m")
    match page:
        case "motor":
            (PAGES / "rig.yaml").write_text(MOTOR, encoding="utf-8")
            fricmodels("simulate", "rig.yaml", "--out", "motor.csv")
            fricmodels("report", "motor.csv", "--inertia", "4.87e-6", *report)
        case "demo" | "demo_tournament":
            fricmodels("demo", "--out", "demo-run", "--jobs", "1")
            fricmodels("report", "demo-run/hidden/diagnosis.json", "--out", PAGES / "demo.html")
            fricmodels("report", "demo-run", "--out", PAGES / "demo_tournament.html")
        case "tournament":
            make("demo")
            fricmodels("report", "demo-run/leaderboard.json", "--out", file)
        case "emps":
            fricmodels("report", "emps/emps_id.csv", "--linear", *emps, *report, where=DATA)
        case "emps_position":
            options = ["--model", "asymmetric-coulomb-viscous", "--linear", *emps, "--score", "position"]
            fricmodels("compare", "emps/emps_id.csv", *options, "--report", file, where=DATA)
        case "laas":
            given = columns(time="Time:s", current="Iq:A", velocity="Velocity:rad/s", position="Position:rad")
            log = "laas_motor/speed_loop_500Hz.csv"
            fricmodels("report", log, *given, "--torque-constant", "0.0318", *report, where=DATA)
        case "tiago":
            names = {"position": "arm_2_position:rad", "velocity": "arm_2_velocity:rad/s"}
            given = columns(time="t:s", torque="arm_2_effort:13.6 N*m", **names)
            fricmodels("report", "tiago/tiago_torso_arm_100Hz.csv", *given, *report, where=DATA)
    return file


def quote(name: str, answer: str) -> None:
    """Put what a page answers into the gallery, where that quotes it."""
    text = GALLERY.read_text(encoding="utf-8")
    pattern = re.compile(QUOTED.format(name=re.escape(name)), re.DOTALL)
    GALLERY.write_text(pattern.sub(lambda found: f"{found[1]}> {answer}\n{found[2]}", text), encoding="utf-8")


def main() -> None:
    """Take the pictures that were asked for."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", choices=sorted({shot.name for shot in SHOTS}), action="append", help="repeatable")
    chosen = parser.parse_args().only or [shot.name for shot in SHOTS]
    from playwright.sync_api import Browser, sync_playwright

    def take(browser: Browser, shot: Shot) -> bytes:
        size = {"width": shot.width, "height": shot.height}
        page = browser.new_page(viewport=size, color_scheme=shot.scheme)  # type: ignore[arg-type]
        page.goto(make(shot.page).as_uri())
        page.evaluate("document.querySelectorAll('main details').forEach(e => { e.open = !e.closest('.tools'); })")
        place = page.locator(f"#{shot.figure}" if shot.figure else ".plot").first
        place.scroll_into_view_if_needed()
        page.locator(f"#{place.get_attribute('id')}[data-drawn]").wait_for()
        if shot.figure:
            return place.locator("xpath=ancestor::figure").screenshot()
        page.evaluate("document.querySelectorAll('main details').forEach(e => { e.open = false; })")
        page.evaluate(
            f"document.getElementById('{shot.section}').scrollIntoView()" if shot.section else "scrollTo(0, 0)"
        )
        page.wait_for_timeout(1500)
        said = page.locator(".verdict .sentence, .verdict dl > div:first-child > dd").all_inner_texts()
        quote(shot.name.removeprefix("gallery_"), " ".join(" ".join(said).split()))
        return page.screenshot()

    with sync_playwright() as driver:
        program = shutil.which("chromium") or shutil.which("google-chrome")
        browser = driver.chromium.launch(executable_path=program, args=["--no-sandbox"])
        for shot in SHOTS:
            if shot.name not in chosen:
                continue
            picture = Image.open(io.BytesIO(take(browser, shot))).convert("RGB").quantize(COLOURS)
            file = PICTURES / f"{shot.name}.png"
            picture.save(file, optimize=True)
            size = file.stat().st_size
            print(f"{file.relative_to(ROOT)}: {size / 1e3:.0f} kB, {picture.width} × {picture.height}", flush=True)
            if size > MOST_BYTES:
                raise SystemExit(f"{file.name} is larger than {MOST_BYTES / 1e3:.0f} kB; take less of the page")
        browser.close()


if __name__ == "__main__":
    main()
