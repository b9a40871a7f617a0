"""What a study says in words of estimators of known mean, bias and noise: nothing that its numbers do not say."""

import textwrap

import pytest
from study_fixtures import RAY, toml

from fogproof.errors import FogproofError, UnsupportedError
from fogproof.reports import read_record, write_report
from fogproof.study import read_study, run_study
from fogproof.study.methods import transmittance

MINE = """
    import numpy as np

    class Drawn:
        sd, bias_of, power = 0.1, 0.0, 0.0

        def __init__(self, scene):
            self.mean = float(np.exp(-float(scene.built_medium.sigma_t) * float(scene.ray.length)))

        def draw(self, rng, n):
            return self.mean * (1 + self.bias_of * float(n) ** self.power) + self.sd * rng.normal(size=n)

    class Plain(Drawn):
        title = "Plain, as it should be"

    class DeclaredAndUnseen(Drawn):
        title, bias, bias_of = "Hardly biased", "by design", 1e-9

    class Falling(Drawn):
        title, bias, bias_of, power, sd = "Falling bias", "by design", 1.0, -0.5, 0.01

    class Level(Drawn):
        title, bias, bias_of, sd = "Level bias", "by design", 0.02, 0.01

    class Rising(Drawn):
        title, bias, bias_of, power, sd = "Rising bias", "by design", 1e-5, 1.0, 1e-6

    class Breaking(Drawn):
        title = "Breaking"

        def draw(self, rng, n):
            if n > 1000:
                raise ValueError("too many")
            return super().draw(rng, n)

    class Linear(Drawn):
        title, dimensions, off = "Linear", 1, 0.0

        def draw(self, rng, n):
            return self.mean * (1 + self.off + np.sqrt(3) * (rng.random((n, 1))[:, 0] - 0.5))

    class LinearOff(Linear):
        title, off = "Linear and off", 0.003

    class Growing(Drawn):
        title = "Growing noise"

        def draw(self, rng, n):
            return self.mean + 0.001 * n * rng.normal(size=n)

    class Outside(Drawn):
        title, bounds = "Outside", (0, 0.5)

    class Alike(Drawn):
        title, bias_of, sd = "Alike and wrong", 0.001, 0.0

    class Exact(Drawn):
        title, sd = "Alike and right", 0.0

    class Certain(Alike):
        variance = 0.0

    class Rare(Drawn):  # hits, and four times in a million one that is worth 5000
        bounds = (0, 5000)

        @property
        def variance(self):
            return 100 + (self.mean - 0.02) - self.mean**2

        def draw(self, rng, n):
            u = rng.random(n)
            return np.where(u < 4e-6, 5000.0, np.where(u < 4e-6 + self.mean - 0.02, 1.0, 0.0))
"""
NAMES = ("Plain", "DeclaredAndUnseen", "Falling", "Level", "Rising", "Growing", "Outside", "Alike", "Exact")


def written(folder, estimators=NAMES, **more):
    folder.mkdir(exist_ok=True)
    (folder / "spoken.py").write_text(textwrap.dedent(MINE))
    scene = {"name": "fog", "quantity": "transmittance", "medium": {"sigma_a": 0.2, "sigma_s": 0.3}, "ray": RAY}
    table = {
        "samples": [16, 256, 4096],
        "replicates": 16,
        "scenes": [{**scene, "estimators": [f"spoken:{name}" for name in estimators]}],
        **more,
    }
    (folder / "study.toml").write_text(toml(table))
    return folder / "study.toml"


@pytest.fixture(scope="module")
def told(tmp_path_factory):
    folder = tmp_path_factory.mktemp("words")
    record = run_study(read_study(written(folder)), folder / "run")
    write_report(read_record(folder / "run"), folder / "run", keep=True)
    return record, (folder / "run" / "index.html").read_text()


def entry(told, name):
    (found,) = (e for e in told[0]["scenes"][0]["estimators"] if e["name"] == f"spoken:{name}")
    return found


def hows(told, name):
    return [target["how"] for target in entry(told, name)["speed"]["targets"]]


def test_what_declares_a_bias_is_never_called_unbiased(told):
    for name in ("DeclaredAndUnseen", "Falling", "Level", "Rising"):
        assert entry(told, name)["status"] == "known", name
    assert told[0]["scenes"][0]["answer"]["best_unbiased"] not in ("spoken:DeclaredAndUnseen", None)
    assert "extrapolated" not in hows(told, "DeclaredAndUnseen")


def test_only_what_stays_is_never_reached(told):
    assert hows(told, "Level") == ["never", "never", "never"]
    assert "never" not in hows(told, "Falling")
    assert hows(told, "Rising") == ["rises", "rises", "rises"]
    assert "16 are nearer" not in entry(told, "Rising")["speed"]["targets"][0]["why"]  # 256 are near enough as well
    assert "256 are nearer" in entry(told, "Rising")["speed"]["targets"][0]["why"]


def test_noise_that_grows_is_no_law_of_independent_samples(told):
    assert set(hows(told, "Growing")) <= {"measured", "less-than", "not-reached", "rises"}


def test_an_error_that_levels_off_has_no_order(told):
    assert entry(told, "Level")["order"] is None
    assert entry(told, "Falling")["order"]["value"] == pytest.approx(0.5, abs=0.2)


def test_what_is_rejected_for_something_else_is_not_called_biased(told):
    record, page = told
    assert entry(told, "Outside")["status"] == "rejected"
    assert "“Outside” (bounds)" in record["scenes"][0]["answer"]["text"]
    assert "1 of 9 estimators is wrong" in page
    assert "rejected: bounds" in page


def test_what_is_alike_and_wrong_is_not_asked_for_more_samples(told):
    assert "all realisations are alike and are not the reference: fog / spoken:Alike." in told[0]["advice"]
    assert "Raise" not in told[0]["advice"]


def test_a_variance_of_0_decides_about_what_is_alike_and_an_exact_one_about_what_was_not_met(tmp_path):
    for seed in range(4):
        record = run_study(
            read_study(written(tmp_path / str(seed), ("Certain", "Rare"), seed=seed)), tmp_path / f"run{seed}"
        )
        certain, rare = record["scenes"][0]["estimators"]
        assert certain["status"] == "rejected"
        assert rare["status"] != "rejected", rare


def test_names_that_somebody_else_wrote_are_kept_as_they_are(told):
    """On the page; the answer names the soonest alone, and which that is the clock says."""
    assert "Plain, as it should be" in told[1]
    assert "plain, as it should be" not in told[1] + told[0]["scenes"][0]["answer"]["text"]


def test_no_interval_on_the_page_is_without_sense(told):
    page = told[1]
    assert "inf]" not in page
    assert "e-305" not in page
    assert "Without any error, and so not drawn: Alike and right." in page
    assert "estimators are" not in page.split("</h1>")[0]


def test_one_count_tells_no_time_of_more_and_draws_no_fall(tmp_path):
    record = run_study(read_study(written(tmp_path, ("Plain",), samples=[16])), tmp_path / "run")
    assert [t["how"] for t in record["scenes"][0]["estimators"][0]["speed"]["targets"]] == ["not-reached"] * 3
    said = "Of “Plain, as it should be” what more samples would take these counts do not tell: add a larger one to `samples`."
    assert said in record["scenes"][0]["answer"]["text"]
    write_report(read_record(tmp_path / "run"), tmp_path / "run", keep=True)
    page = (tmp_path / "run" / "index.html").read_text()
    assert "Error against samples" not in page
    assert "of 1 estimators, both" not in page
    assert ">: 1 scene" not in page


def test_what_cannot_be_drawn_is_named_and_not_waited_for(tmp_path):
    record = run_study(read_study(written(tmp_path, ("Plain", "Breaking"))), tmp_path / "run")
    scene = record["scenes"][0]
    assert [t["how"] for t in scene["estimators"][1]["speed"]["targets"]] == ["not-reached"] * 3
    assert {t["why"] for t in scene["estimators"][1]["speed"]["targets"]} == {"larger counts could not be drawn"}
    assert "Failed at 4096: “Breaking”." in scene["answer"]["notes"]
    assert all("spoken:Breaking" not in row["all"]["waiting"] for row in scene["answer"]["soonest"] if row["all"])
    assert "add a larger" not in scene["answer"]["text"]


def test_where_a_bias_stays_no_more_samples_are_asked_for(tmp_path):
    record = run_study(read_study(written(tmp_path, ("Level",))), tmp_path / "run")
    said = record["scenes"][0]["answer"]["text"]
    assert said.startswith("None comes within 1 %, and none will: the bias of “Level bias” stays.")
    assert "Raise" not in said + record["advice"]


def test_what_sobol_points_show_to_be_biased_is_not_unbiased_with_random_ones(tmp_path):
    """A bias below what random points resolve: scrambled points have the same mean, and a hundredth of the noise."""
    right, _, random, sobol = run_study(read_study(written(tmp_path, ("Linear", "LinearOff"))), tmp_path / "run")[
        "scenes"
    ][0]["estimators"]
    assert sobol["status"] == "rejected"
    assert random["status"] == "inconclusive"
    assert "with Sobol points" in random["findings"][-1]["message"]
    assert "extrapolated" not in [t["how"] for t in random["speed"]["targets"]]
    assert right["status"] == "passed"


def test_few_realisations_are_no_heavy_tail(tmp_path):
    record = run_study(read_study(written(tmp_path, ("Plain",), samples=[1], replicates=8)), tmp_path / "run")
    assert record["scenes"][0]["estimators"][0]["warning"] == ""


def test_a_study_that_cannot_run_leaves_nothing_that_the_mended_one_does_not_fit_into(tmp_path):
    path = written(tmp_path, ("Plain",))
    text = path.read_text()
    path.write_text(text.replace("spoken:Plain", "regular"))
    with pytest.raises(FogproofError, match="VoxelGrid"):
        run_study(read_study(path), tmp_path / "run")
    path.write_text(text)
    run_study(read_study(path), tmp_path / "run")


TWINS = """
    import numpy as np

    class One:
        title = "Alpha"

        def __init__(self, scene):
            self.mean = float(np.exp(-float(scene.built_medium.sigma_t) * float(scene.ray.length)))

        def draw(self, rng, n):
            return self.mean + 0.1 * rng.normal(size=n)

    class Other(One):
        title, bias = "Alpha", "by design"
"""


def test_estimators_of_one_title_are_told_apart_by_their_kinds(tmp_path):
    path = written(tmp_path, ("One", "Other"))
    (tmp_path / "spoken.py").write_text(textwrap.dedent(TWINS))
    record = run_study(read_study(path), tmp_path / "run")
    labels = [e["label"] for e in record["scenes"][0]["estimators"]]
    assert labels == ["Alpha (spoken:One)", "Alpha (spoken:Other)"]


def test_where_none_is_unbiased_that_is_said_once(tmp_path):
    """More counts would not help: nobody is waited for."""
    record = run_study(read_study(written(tmp_path, ("DeclaredAndUnseen", "Falling"))), tmp_path / "run")
    assert "None is judged unbiased." in record["scenes"][0]["answer"]["text"].split("\n")
    write_report(read_record(tmp_path / "run"), tmp_path / "run", keep=True)
    page = (tmp_path / "run" / "index.html").read_text()
    assert "<p>None is judged unbiased.</p>" in page
    assert "Of the unbiased</caption>" not in page


@pytest.mark.parametrize("count", [64, 1024])
def test_hits_that_never_missed_are_judged_by_their_bounds(tmp_path, count):
    """A transmittance of 1 - 2e-9: no miss is met, and the law of hits and misses tells how much it can matter."""
    path = written(tmp_path, ("Plain",), samples=[count])
    scene = {
        "name": "thin",
        "quantity": "transmittance",
        "medium": {"sigma_a": 1e-9, "sigma_s": 1e-9},
        "ray": {**RAY, "length": 1},
    }
    path.write_text(
        toml({"samples": [count], "replicates": 16, "scenes": [{**scene, "estimators": ["analog", "delta"]}]})
    )
    record = run_study(read_study(path), tmp_path / "run")
    assert {e["status"] for e in record["scenes"][0]["estimators"]} == {"passed"}
    assert record["advice"] == ""


def test_a_method_of_which_the_oracle_knows_no_variance_is_told_before_it_is_drawn(tmp_path, monkeypatch):
    """With the scene and the estimator, and no folder that the mended study would not fit into."""
    path = written(tmp_path, ("Plain",))
    path.write_text(path.read_text().replace("spoken:Plain", "ratio"))

    def refuses(*_):
        raise UnsupportedError("no such variance", "variance")

    monkeypatch.setattr(transmittance, "transmittance_variance", refuses)
    with pytest.raises(FogproofError, match="scene 'fog', ratio: no such variance"):
        run_study(read_study(path), tmp_path / "run")
    assert not (tmp_path / "run").exists()


def test_nothing_to_collide_with_has_no_variance(tmp_path):
    path = written(tmp_path, ("Plain",), samples=[64])
    text = (
        path.read_text()
        .replace("spoken:Plain", "ratio")
        .replace("sigma_a = 0.2", "sigma_a = 0")
        .replace("sigma_s = 0.3", "sigma_s = 0")
    )
    path.write_text(text)
    record = run_study(read_study(path), tmp_path / "run")
    assert record["scenes"][0]["estimators"][0]["status"] == "passed"
