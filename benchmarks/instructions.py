"""Instructions per update of the exported estimators on an emulated Cortex-M, and 10⁸ updates on this machine.

Needs ``gcc-arm-none-eabi``, ``libnewlib-arm-none-eabi`` and ``qemu-system-arm``. QEMU is run with one instruction a
nanosecond (``-icount shift=0``); the program reads the processor's own timer, which a loop of known length calibrates.
``--updates N`` runs the same headers N times on this machine instead (``cc``), and watches time and covariance.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

import fricmodels
from fricmodels.drive import Drive
from fricmodels.export.targets import export_model
from fricmodels.model import Model
from fricmodels.recording import Recording
from fricmodels.rig import Rig

SAMPLES = 400
WARM = 200
CASES = {
    "rls of 6": ("rls", "coulomb-viscous+gravity+torque-offset", 2500),
    "ekf of 9": ("ekf", "asymmetric-coulomb-viscous+gravity+torque-offset", 10_000),
    "detchmendy-sridhar of 9": ("detchmendy-sridhar", "asymmetric-coulomb-viscous+gravity+torque-offset", 10_000),
}
"""Estimator, model (the inertia is estimated too), and the instructions that an update may take."""
PROCESSORS = {
    "Cortex-M7, double precision in hardware": ("mps2-an500", ["-mcpu=cortex-m7", "-mfpu=fpv5-d16"]),
    "Cortex-M4, double precision in software": ("mps2-an386", ["-mcpu=cortex-m4", "-mfpu=fpv4-sp-d16"]),
}
TOOLS = ("arm-none-eabi-gcc", "qemu-system-arm")

MEMORY = """MEMORY { code (rx): ORIGIN = 0, LENGTH = 4M
         data (rw): ORIGIN = 0x20000000, LENGTH = 4M }
SECTIONS { .text : { KEEP(*(.vectors)) *(.text*) *(.rodata*) } > code
           .ARM.exidx : { *(.ARM.exidx*) } > code
           .data : { *(.data*) } > data
           .bss : { *(.bss*) *(COMMON) } > data }
"""
STARTUP = """
#include "j.h"
#include "samples.h"
static void reset(void);
__attribute__((section(".vectors"), used)) static void *const vectors[] = {(void *)0x20100000, (void *)reset};
#define TICK_CONTROL (*(volatile unsigned *)0xE000E010)
#define TICK_RELOAD (*(volatile unsigned *)0xE000E014)
#define TICK_NOW (*(volatile unsigned *)0xE000E018)
static void say(int what, const void *text) {
    register int r0 __asm__("r0") = what;
    register const void *r1 __asm__("r1") = text;
    __asm__ volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
}
static void print(unsigned value) {
    char text[12];
    int i = 11;
    text[i] = 0;
    text[--i] = ' ';
    do { text[--i] = (char)('0' + value % 10); value /= 10; } while (value);
    say(4, text + i);
}
static j_online filter;
static volatile double sink;
static void reset(void) {
    unsigned begin, end, count = 1000000;
    int k;
    *(volatile unsigned *)0xE000ED88 |= 0xF << 20;
    __asm__ volatile("dsb\\nisb");
    TICK_RELOAD = 0xFFFFFF;
    TICK_NOW = 0;
    TICK_CONTROL = 5;
    begin = TICK_NOW;
    __asm__ volatile("1: subs %0, %0, #1\\n bne 1b" : "+r"(count) : : "cc");
    end = TICK_NOW;
    print((begin - end) & 0xFFFFFF);
    j_online_begin(&filter);
    for (k = 0; k < WARM; k++) j_online_update(&filter, &samples[k]);
    begin = TICK_NOW;
    for (; k < SAMPLES; k++) j_online_update(&filter, &samples[k]);
    end = TICK_NOW;
    print((begin - end) & 0xFFFFFF);
    sink = j_online_parameter(&filter, 0);
    say(0x18, (void *)0x20026);
    for (;;) {}
}
"""
LONG = """
#define _POSIX_C_SOURCE 199309L
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#include "j.h"
#include "samples.h"
static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}
static double least(const double *p, int n) { /* smallest pivot of the covariance, its diagonal scaled to 1 */
    double a[32][32], worst = 1e300;
    int i, j, k;
    for (i = 0; i < n; i++) for (j = 0; j <= i; j++) a[i][j] = a[j][i] = p[i * (i + 1) / 2 + j];
    for (i = 0; i < n; i++) for (j = 0; j < n; j++) if (i != j) a[i][j] /= sqrt(a[i][i] * a[j][j]);
    for (i = 0; i < n; i++) a[i][i] = a[i][i] > 0.0 ? 1.0 : -1.0;
    for (k = 0; k < n; k++) {
        if (!(a[k][k] >= worst)) worst = a[k][k];
        for (i = k + 1; i < n; i++) for (j = k + 1; j < n; j++) a[i][j] -= a[i][k] * a[k][j] / a[k][k];
    }
    return worst;
}
int main(int count, char **arguments) {
    static j_online filter;
    const long updates = atol(arguments[1]), rest = atol(arguments[2]);
    double worst = 1e300, begin = now(), first = 0.0, last = 0.0, mark = begin;
    long k;
    int i;
    (void)count;
    j_online_begin(&filter);
    for (k = 0; k < updates; k++) {
        j_online_sample s = samples[k % SAMPLES];
        if (k >= rest) {
            s = samples[0];
            s.velocity = s.motor_torque = 0.0;
        }
        s.time = (double)k * INTERVAL;
        j_online_update(&filter, &s);
        if (k % (updates / 100) == updates / 100 - 1) {
            const double pivot = least(filter.memory + ORDER, ORDER);
            if (!(pivot >= worst)) worst = pivot;
        }
        if (k == updates / 10 - 1) first = now() - begin;
        if (k == updates - updates / 10 - 1) mark = now();
    }
    last = now() - mark;
    printf("{\\"seconds\\": %.17g, \\"first_tenth\\": %.17g, \\"last_tenth\\": %.17g, \\"smallest_pivot\\": %.17g, "
           "\\"bytes\\": %d, \\"parameters\\": [", now() - begin, first, last, worst, (int)sizeof filter);
    for (i = 0; i < PARAMETERS; i++) printf("%s%.17g", i ? ", " : "", j_online_parameter(&filter, i));
    printf("]}\\n");
    return 0;
}
"""


def recording() -> Recording:
    """Return a recording of a joint under gravity; its motion repeats itself after :data:`SAMPLES` samples."""
    rig = Rig.model_validate(
        {
            "name": "joint",
            "inertia": 1.8,
            "friction": {"viscous": 6.0, "coulomb": 9.0},
            "effects": [{"name": "gravity", "sine": 4.0, "cosine": 1.0}],
            "excitation": {"kind": "tracking", "velocity": 10.0, "frequency": 1.25, "lines": 4, "bandwidth": 8.0},
            "sensors": {"velocity_noise_percent": 1.0},
            "rate": 500,
            "samples": 8000,
        }
    )
    return rig.simulate()


def headers(folder: Path) -> Iterator[tuple[str, Path, int, int, list[str]]]:
    """Yield each case: its name, a folder with header and samples, the budget, the filter's order, its parameters."""
    made = recording()
    for title, (estimator, name, budget) in CASES.items():
        model = fricmodels.keep(fricmodels.compare(made, Drive(Model.parse(name)).model))
        text = export_model(model, "c", name="j", online=estimator, recording=made).text
        place = folder / title.replace(" ", "-")
        place.mkdir()
        (place / "j.h").write_text(text, encoding="ascii")
        block = text.split("} j_online_sample;")[0].rpartition("typedef struct {")[2]
        fields = [line.split()[1].rstrip(";") for line in block.splitlines() if line.strip().startswith("double")]
        names = {"motor_torque": "torque"}
        zero = np.zeros(len(made))
        columns = [made.channels.get(names.get(field, field), zero) for field in fields]
        rows = ",\n".join(
            "{" + ", ".join(repr(float(c[k])) for c in columns) + "}" for k in range(len(made) - SAMPLES, len(made))
        )
        (place / "samples.h").write_text(
            f"static const j_online_sample samples[SAMPLES] = {{{rows}}};\n", encoding="ascii"
        )
        memory = int(text.partition("double memory[")[2].partition("]")[0])
        order = next(n for n in range(1, 64) if n + n * (n + 1) // 2 == memory)
        yield title, place, budget, order, list(model.drive.keys)


def counted(place: Path, machine: str, options: list[str]) -> float:
    """Return the instructions of an update, a mean over 200."""
    (place / "main.c").write_text(STARTUP, encoding="ascii")
    (place / "memory.ld").write_text(MEMORY, encoding="ascii")
    given = [*options, "-mthumb", "-mfloat-abi=hard", "-O2", "-std=gnu99", f"-DSAMPLES={SAMPLES}", f"-DWARM={WARM}"]
    subprocess.run(
        [TOOLS[0], *given, "-nostartfiles", "--specs=nosys.specs", "-T", "memory.ld", "main.c", "-lm", "-o", "a.elf"],
        cwd=place, check=True, capture_output=True, text=True,
    )  # fmt: skip
    emulated = [TOOLS[1], "-M", machine, "-nographic", "-icount", "shift=0", "-kernel", "a.elf"]
    done = subprocess.run(
        [*emulated, "-semihosting-config", "enable=on,target=native"],
        cwd=place, check=False, capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    ticks = [int(word) for word in (done.stdout + done.stderr).split()[:2]]
    return ticks[1] * 2e6 / ticks[0] / (SAMPLES - WARM)


def missing() -> list[str]:
    """Return the tools that are not installed."""
    return [tool for tool in TOOLS if shutil.which(tool) is None]


def long_run(place: Path, order: int, parameters: int, updates: int, rest: int) -> dict[str, Any]:
    """Run a header on this machine for many updates, from ``rest`` on at rest."""
    (place / "long.c").write_text(LONG, encoding="ascii")
    defined = {"SAMPLES": SAMPLES, "INTERVAL": 0.002, "ORDER": order, "PARAMETERS": parameters}
    given = [f"-D{key}={value}" for key, value in defined.items()]
    subprocess.run(["cc", "-O2", "-std=c99", *given, "long.c", "-lm", "-o", "long"], cwd=place, check=True)
    done = subprocess.run(["./long", str(updates), str(rest)], cwd=place, check=True, capture_output=True, text=True)
    return dict(json.loads(done.stdout))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--updates", type=int, help="run so many updates on this machine instead")
    parser.add_argument("--json", action="store_true", help="print plain data")
    arguments = parser.parse_args()
    if arguments.updates is None and missing():
        sys.exit(f"not installed: {', '.join(missing())}; apt-get install gcc-arm-none-eabi libnewlib-arm-none-eabi "
                 "qemu-system-arm, or count seconds here with --updates 100000000")  # fmt: skip
    found: list[dict[str, Any]] = []
    with tempfile.TemporaryDirectory() as folder:
        for title, place, budget, order, keys in headers(Path(folder)):
            if arguments.updates is not None:
                for what, rest in (("motion", arguments.updates), ("rest", arguments.updates // 10)):
                    row = long_run(place, order, len(keys), arguments.updates, rest)
                    found.append({"case": title, "then": what, **row})
                    print(json.dumps(found[-1]), flush=True)
                continue
            for processor, (machine, options) in PROCESSORS.items():
                count = counted(place, machine, options)
                found.append({"case": title, "processor": processor, "instructions": count, "budget": budget})
                if not arguments.json:
                    print(f"{title}, {processor}: {count:.0f} instructions an update (budget {budget})", flush=True)
    if arguments.json:
        print(json.dumps(found))


if __name__ == "__main__":
    main()
