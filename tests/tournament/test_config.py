"""Configurations say in one line what is wrong with them, and where."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricmodels import plugins
from fricmodels.errors import InputError
from fricmodels.tournament import load_config
from fricmodels.tournament.demonstration import demonstration
from fricmodels.tournament.sources import sources

CONFIGS = sorted((Path(__file__).parents[2] / "configs").glob("*.yaml"))

MOTOR = """\
name: test
datasets:
  - name: motor
    simulate:
      model: coulomb-viscous
      parameters: {K_v: 1.0e-4, K_c: 1e-2}
      inertia: 4.87e-6
      amplitude: 0.02
      frequency: 39.54
models: coulomb-viscous
estimators: all
"""


@pytest.fixture
def config(tmp_path: Path) -> Path:
    file = tmp_path / "config.yaml"
    file.write_text(MOTOR, encoding="utf-8")
    return file


@pytest.mark.parametrize("file", CONFIGS, ids=lambda file: file.stem)
def test_every_config_is_valid(file: Path) -> None:
    loaded = load_config(file)
    assert loaded.model_names
    assert loaded.entrants


def test_the_demonstration_is_its_yaml() -> None:
    written = next(file for file in CONFIGS if file.stem == "demo")
    assert load_config(written) == demonstration()


def test_numbers_and_lists(config: Path) -> None:
    loaded = load_config(config)
    simulate = loaded.datasets[0].simulate
    assert simulate is not None
    assert simulate.parameters == {"K_v": 1e-4, "K_c": 1e-2}
    assert simulate.amplitude == [0.02]
    assert simulate.seeds == [0]
    assert {entrant.name for entrant in loaded.entrants} == set(plugins.load().estimators)


def test_matrix_of_noise_seeds_and_amplitudes(config: Path) -> None:
    text = MOTOR.replace("amplitude: 0.02", "amplitude: [0.02, 0.03]")
    text = text.replace("frequency: 39.54", "frequency: 39.54\n      noise_percent: [0, 5, 10]\n      seeds: 4")
    config.write_text(text)
    listed, left_out = sources(load_config(config), config.parent)
    assert len(listed) == 2 * 3 * 4
    assert not left_out
    assert listed[0].tags == {"amplitude": 0.02, "noise_percent": 0.0, "seed": 0}
    assert len({source.description for source in listed}) == len(listed)


@pytest.mark.parametrize(
    ("old", "new", "line", "words"),
    [
        ("models: ", "model: ", 10, "key 'model' is unknown; did you mean 'models'?"),
        ("inertia: ", "inertja: ", 7, "key 'inertja' in 'datasets.simulate' is unknown; did you mean 'inertia'?"),
        ("inertia: 4.87e-6", "inertia: -1", 7, "key 'inertia'"),
        ("inertia: 4.87e-6", "inertia: .nan", 7, "key 'inertia'"),
        ("      inertia: 4.87e-6\n", "", 4, "key 'inertia' in 'datasets.simulate' is missing"),
        ("amplitude: 0.02", "amplitude: big", 8, "key 'amplitude'"),
        ("amplitude: 0.02", "amplitude: []", 8, "key 'amplitude'"),
        ("models: coulomb-viscous", "models: [coulomb-viscos]", 10, "unknown law 'coulomb-viscos'; did you mean 'coul"),
        ("models: coulomb-viscous", "models: coulomb-viscous+coging", 10, "unknown effect 'coging'; did you mean 'cog"),
        ("models: coulomb-viscous", "models: all+coging", 10, "unknown effect 'coging'"),
        ("estimators: all", "estimators: [all, bach]", 11, "unknown estimator 'bach'"),
        (
            "estimators: all",
            "estimators: {name: ekf, settings: {nope: 1}}",
            11,
            "settings of 'ekf': key 'nope' is unknown",
        ),
        (
            "estimators: all",
            "estimators: all\nscore: papper",
            12,
            "key 'score' cannot be 'papper'; did you mean 'paper'?",
        ),
        ("estimators: all", "estimators: all\nrank_by: rms", 12, "key 'rank_by' cannot be 'rms'"),
        ("estimators: all", "estimators: all\ntimeout: 0", 12, "key 'timeout'"),
        ("K_c: 1e-2", "K_x: 1e-2", 6, "key 'K_x' is no parameter of 'coulomb-viscous'; did you mean 'K_"),
        (", K_c: 1e-2", "", 6, "key 'K_c', a parameter of 'coulomb-viscous', is missing"),
        ("model: coulomb-viscous", "model: coulomb-viscus", 5, "key 'model': unknown law 'coulomb-viscus'"),
        ("    simulate:", "    files: x.csv\n    simulate:", 3, "both 'files' and 'simulate'"),
        ("name: test", "name: !!python/name:os.system ''", 1, "refused"),
        ("name: test", "name: test\nname: test", 2, "stands twice"),
    ],
)
def test_errors_name_line_key_and_the_nearest_right_one(
    config: Path, old: str, new: str, line: int, words: str
) -> None:
    assert old in MOTOR
    config.write_text(MOTOR.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load_config(config)
    message = str(caught.value)
    assert message.startswith(f"{config}:{line}: "), message
    assert words in message
    assert "\n" not in message


def test_a_motor_that_is_mounted_the_other_way_round_has_a_negative_constant(config: Path) -> None:
    source = "datasets:\n  - files: log.csv\n    torque_constant: {}\nmodels: coulomb-viscous\nestimators: batch\n"
    config.write_text(source.format(-0.123))
    assert load_config(config).datasets[0].torque_constant == -0.123
    for wrong in (0, ".inf"):
        config.write_text(source.format(wrong))
        with pytest.raises(InputError, match=":3: key 'torque_constant'"):
            load_config(config)


def test_a_list_at_the_top_is_refused(config: Path) -> None:
    config.write_text("- a\n- b\n")
    with pytest.raises(InputError, match="a mapping of keys is expected"):
        load_config(config)


def test_absent_files(config: Path) -> None:
    start = MOTOR.index("    simulate:")
    end = MOTOR.index("models:")
    config.write_text(MOTOR[:start] + "    files: ['*.csv']\n" + MOTOR[end:])
    with pytest.raises(InputError, match=r"no file '\*\.csv'"):
        sources(load_config(config), config.parent)
    config.write_text(MOTOR[:start] + "    files: ['*.csv']\n    optional: true\n" + MOTOR[end:])
    listed, left_out = sources(load_config(config), config.parent)
    assert not listed
    assert "motor" in left_out[0]


def test_globs_give_each_file_a_name(config: Path) -> None:
    start = MOTOR.index("    simulate:")
    end = MOTOR.index("models:")
    for name in ("b", "a"):
        (config.parent / f"{name}.csv").write_text("time_s,torque_Nm,velocity_rad_s\n")
    config.write_text(MOTOR[:start] + "    files: ['*.csv', a.csv]\n" + MOTOR[end:])
    listed, _ = sources(load_config(config), config.parent)
    assert [source.dataset for source in listed] == ["motor/a", "motor/b"]


def test_two_datasets_of_one_name(config: Path) -> None:
    config.write_text(MOTOR.replace("models:", "  - *again\nmodels:").replace("  - name", "  - &again\n    name"))
    with pytest.raises(InputError, match="two datasets are called 'motor'"):
        sources(load_config(config), config.parent)
