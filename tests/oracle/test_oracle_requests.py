"""The oracle's protocol: every quantity is answered and described by the published schema, every fault gets its own answer."""

import json
import subprocess
import sys
from pathlib import Path
from types import FunctionType

import jsonschema
import numpy as np
import pydantic
import pytest

from fogproof import HenyeyGreenstein, analytic
from fogproof.oracle import PROTOCOL, answer_text, schema
from fogproof.oracle.answers import to_json
from fogproof.oracle.limits import Limits
from fogproof.quantities import quantities

ROOT = Path(__file__).resolve().parents[2]
RAY = {"origin": [0, 0, -2], "direction": [0, 0, 1], "length": 5}
FOG = {"sigma_a": 0.1, "sigma_s": 0.4}
ATMOSPHERE = {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9}
VOXELS = {"kind": "voxel-grid", "sigma_t": [[[1.0, 2.0]], [[0.5, 0.0]]], "lower": [-1, -1, -1], "upper": [1, 1, 1]}
LAMP = {"position": [1, 1, 0], "intensity": 3}
HG = {"kind": "henyey-greenstein", "g": 0.6}
MIXED = {"kind": "mixture", "components": [HG, {"kind": "rayleigh"}], "weights": [0.25, 0.75]}

EXAMPLES = [{"quantity": name, **quantity.example} for name, quantity in quantities().items()]
REQUESTS = [
    {"quantity": "optical_thickness", "medium": VOXELS, "ray": {**RAY, "origin": [0.5, 0.5, -2]}},
    {"quantity": "transmittance", "medium": FOG, "ray": {**RAY, "length": "inf"}},
    {"quantity": "transmittance", "medium": ATMOSPHERE, "ray": {**RAY, "length": [1, 2, 3]}, "id": "three"},
    {"quantity": "free_path", "medium": ATMOSPHERE, "ray": RAY, "tau": [0.01, 0.1, 100]},
    {"quantity": "ambient_fog", "medium": {**FOG, "emission": 2}, "ray": RAY, "ambient": [0.1, 0.2, 0.3]},
    {"quantity": "emitted_radiance", "medium": {**FOG, "emission": 2}, "ray": RAY, "times_sigma_a": False},
    {"quantity": "white_furnace", "medium": {"sigma_a": 0, "sigma_s": 3}, "ray": RAY},
    {"quantity": "thermal_furnace", "medium": {**FOG, "emission": 2}, "ray": RAY, "radiance": 2},
    {"quantity": "single_scattering", "medium": {**FOG, "phase": MIXED}, "ray": RAY, "light": LAMP},
    {"quantity": "single_scattering", "medium": FOG, "ray": RAY, "light": {"kind": "environment", "radiance": 2}},
    {"quantity": "single_scattering", "medium": FOG, "ray": RAY, "light": LAMP,
     "occluders": [{"kind": "sphere", "center": [0.5, 0.5, 0], "radius": 0.1}]},
    {"quantity": "radiance", "medium": {**FOG, "emission": 1}, "ray": RAY, "scattering": "single", "light": LAMP, "background": 2},
    {"quantity": "transmittance_second_moment", "medium": VOXELS, "ray": RAY,
     "tracking": "residual-ratio", "majorant": 2, "control": 1},
    {"quantity": "ambient_fog_variance", "medium": FOG, "ray": RAY, "ambient": 1},
    {"quantity": "air_cross_section", "wavelength": [4e-7, 5e-7]},
    {"quantity": "air_optical_depth", "wavelength": 5e-7},
    {"quantity": "plane_parallel_sky", "tau": [0.1, 0.3], "mu_sun": 0.5, "mu_view": 0.9, "azimuth": 0},
    {"quantity": "sky_colour", "mu_sun": 0.5, "mu_view": [0.5, 0.9], "azimuth": 0},
    {"quantity": "sun_colour", "air_mass": [1, 10]},
    {"quantity": "transmittance_variance", "medium": ATMOSPHERE, "ray": RAY, "tracking": "ratio", "majorant": 2},
    {"quantity": "transmittance_lookups", "medium": FOG, "ray": RAY, "tracking": "delta", "majorant": 2},
    {"quantity": "single_scattering_variance", "medium": FOG, "ray": RAY, "light": LAMP, "sampling": "equiangular"},
    {"quantity": "airlight_integral", "sigma_t": 0.5, "h": [0.1, 1], "a": -2, "b": "inf", "phase": HG},
    {"quantity": "airlight_integral", "sigma_t": 0.5, "h": 1, "a": -2, "b": 3, "method": "pegoraro2009"},
    {"quantity": "airlight_table", "sigma_t": 0.5, "h": [0.1, 1], "a": [-2, -1], "b": [0, 1, 2]},
    {"quantity": "phase_pdf", "phase": {"kind": "draine", "g": 0.3, "alpha": 1}, "mu": [-1, 0, 1]},
    {"quantity": "phase_cdf", "phase": {"kind": "hazy"}, "mu": 0.5},
    {"quantity": "phase_quantile", "phase": MIXED, "xi": [0.1, 0.9]},
    {"quantity": "phase_mean_cosine", "phase": {"kind": "cornette-shanks", "g": 0.7}},
    {"quantity": "rayleigh_scattering_coefficient", "diameter": 3e-10, "refractive_index": [1.5, 0.1], "number_density": 2.5e25,
     "wavelength": [4e-7, 7e-7]},
]  # fmt: skip

AIRLIGHT, METHOD = [request for request in REQUESTS if request["quantity"] == "airlight_integral"]
PHASE = next(request for request in REQUESTS if request["quantity"] == "phase_pdf")


@pytest.fixture(scope="module")
def published():
    return json.loads((ROOT / "schemas/oracle-1.json").read_text())


def test_the_published_schema_is_current(published):
    if tuple(map(int, pydantic.VERSION.split(".")[:2])) < (2, 11):
        pytest.skip(f"pydantic {pydantic.VERSION} writes the same schema in other words")
    assert published == json.loads(json.dumps(schema())), "run: fogproof oracle --schema > schemas/oracle-1.json"
    jsonschema.Draft202012Validator.check_schema(published)


def test_every_public_function_is_a_quantity():
    """A function that forgets to declare itself would not answer programs; only what gives a value of a case is no question."""
    functions = {name for name in analytic.__all__ if isinstance(getattr(analytic, name), FunctionType)}
    assert functions - set(quantities()) <= {"golden_values", "delta_m"}


def test_every_argument_says_what_it_means():
    silent = [f"{q.name}: {name}" for q in quantities().values() for name in q.arguments if not q.meanings.get(name)]
    assert not silent, "add a line to the docstring"


def _validate(instance, schema_):
    """Hold an instance to a schema, which has been checked itself before."""
    jsonschema.Draft202012Validator(schema_).validate(instance)


def _schema_of(quantity, published):
    """Return the schema of one quantity's requests: to try all sixty takes a second."""
    definitions = published["$defs"]
    models = [m for m in definitions.values() if m.get("properties", {}).get("quantity", {}).get("const") == quantity]
    assert len(models) == 1
    return {**models[0], "$defs": definitions}


@pytest.mark.parametrize("request_", [*EXAMPLES, *REQUESTS], ids=lambda r: r["quantity"])
def test_a_request_is_valid_and_answered(published, request_):
    _validate(request_, _schema_of(request_["quantity"], published))
    answer = json.loads(to_json(answer_text(json.dumps(request_))))
    _validate(answer, {**published["$defs"]["answer"], "$defs": published["$defs"]})
    assert np.shape(answer["value"]) == np.shape(answer["error"])
    assert answer["protocol"] == PROTOCOL
    assert answer.get("id") == request_.get("id")


def test_answers_are_those_of_the_functions():
    answer = answer_text(json.dumps(AIRLIGHT))
    direct = analytic.airlight_integral(0.5, [0.1, 1], -2, np.inf, HenyeyGreenstein(0.6))
    np.testing.assert_array_equal(answer["value"], direct.value)


FAULTS = [
    ("{", "", "invalid-input", "not valid JSON"),
    ("[1]", "", "invalid-input", "must be a JSON object"),
    ("{}", "quantity", "invalid-input", "quantity is missing; known are"),
    ('{"quantity": "luck"}', "quantity", "invalid-input", "'luck' is not known"),
    ('{"quantity": ["a"]}', "quantity", "invalid-input", "is not known"),
    (json.dumps({**REQUESTS[1], "ray": {**RAY, "length": -1}}), "ray.length", "invalid-value", "length must be >= 0"),
    (json.dumps({**REQUESTS[1], "medium": {"sigma_a": 1}}), "medium.sigma_s", "invalid-input", "is missing"),
    (json.dumps({**REQUESTS[1], "medium": {**FOG, "kind": "gas"}}), "medium", "invalid-input", "known are"),
    (json.dumps({**AIRLIGHT, "method": "magic"}), "method", "invalid-input", "method"),
    (json.dumps({**AIRLIGHT, "h": -1}), "h", "invalid-value", "h must be finite and >= 0"),
    (json.dumps({**PHASE, "mu": 1.5}), "mu", "invalid-value", "mu"),
    (json.dumps({**PHASE, "phase": {"kind": "henyey-greenstein", "g": 1}}), "phase.g", "invalid-value", "open interval"),
    (json.dumps({**METHOD, "phase": {"kind": "rayleigh"}, "method": "sun2005"}), "", "unsupported", ""),
]  # fmt: skip
ABOUT_ANOTHER = {
    "quantity": "gradient",
    "wrt": "mu0",
    "of": {"quantity": "half_space_reflectance", "albedo": 0.9, "mu0": 0.5},
}
FAULTS += [
    (json.dumps({**ABOUT_ANOTHER, "of": ABOUT_ANOTHER}), "of.quantity", "unsupported", "none that can be asked about"),
    (
        json.dumps({**ABOUT_ANOTHER, "of": {**PHASE, "phase": {"kind": "gas"}}}),
        "of.phase",
        "invalid-input",
        "known are",
    ),
    (json.dumps({"quantity": "scattering_count_mean", "of": PHASE}), "of.quantity", "unsupported", "no albedo"),
    (json.dumps({**ABOUT_ANOTHER, "wrt": "luck"}), "wrt", "invalid-value", "none of albedo, mu0"),
]


def test_a_question_about_another_is_that_of_the_function():
    answer = answer_text(json.dumps(ABOUT_ANOTHER))
    direct = analytic.gradient("half_space_reflectance", "mu0", albedo=0.9, mu0=0.5)
    assert (answer["value"], answer["error"]) == (direct.value, direct.error)
    scene = {"quantity": "radiance", "medium": FOG, "ray": RAY, "background": 1}
    steep = answer_text(json.dumps({"quantity": "gradient", "of": scene, "wrt": "background"}))
    through = answer_text(json.dumps({"quantity": "transmittance", "medium": FOG, "ray": RAY}))
    np.testing.assert_allclose(steep["value"], through["value"], rtol=1e-12)


@pytest.mark.parametrize(("text", "path", "code", "message"), FAULTS)
def test_a_fault_gets_code_message_and_path(published, text, path, code, message):
    failure = answer_text(text)
    _validate(failure, {**published["$defs"]["failure"], "$defs": published["$defs"]})
    error = failure["error"]
    assert (error["code"], error["path"]) == (code, path) or code == "unsupported" == error["code"]
    assert message in error["message"]


def test_a_conversation_over_a_pipe():
    """A program that writes one line and waits gets its answer before it writes the next."""
    command = [sys.executable, "-c", "from fogproof.cli import main; main(['oracle', '-'])"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1) as oracle:
        for mu in (0.0, 0.5):
            oracle.stdin.write(json.dumps({"quantity": "phase_pdf", "phase": HG, "mu": mu}) + "\n")
            oracle.stdin.flush()
            assert json.loads(oracle.stdout.readline())["value"] > 0
        oracle.stdin.close()
        assert oracle.wait(timeout=60) == 0


PROVEN = [request for request in REQUESTS if "rigorous" in quantities()[request["quantity"]].arguments]


@pytest.mark.parametrize("request_", PROVEN, ids=lambda r: r["quantity"])
def test_a_proven_enclosure_lies_within_the_ordinary_answer(request_):
    ordinary, proven = (answer_text(json.dumps(request_), rigorous) for rigorous in (False, True))
    assert "ball" in proven["method"].lower()
    assert np.all(np.abs(ordinary["value"] - proven["value"]) + proven["error"] <= ordinary["error"] + 1e-300)


def test_what_has_no_proof_says_so():
    assert answer_text(json.dumps(PHASE), True)["error"]["code"] == "unsupported"


@pytest.mark.parametrize(
    ("mu", "words"),
    [
        ([[1, 2], [3]], "mu must be a number or an array of numbers, got"),
        ("0.5", "mu must be a number or an array of numbers, got '0.5'"),
        (json.loads("[" * 17 + "1" + "]" * 17), "mu must have at most 16 axes, got 17"),
    ],
)
def test_what_is_wrong_with_an_array_is_said_of_its_argument(mu, words):
    request = {"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": mu}
    error = answer_text(json.dumps(request))["error"]
    assert words in error["message"]
    assert error["path"] == "mu"


def test_an_alarm_that_rings_at_once_is_a_timeout():
    answer = answer_text(json.dumps({"quantity": "phase_pdf", "phase": HG, "mu": 0}), limits=Limits(seconds=1e-6))
    assert answer["error"]["code"] == "timeout"
