"""Golden tables say the same in every format, hold what is proven, and compile."""

import csv
import io
import json
import math
import shutil
import subprocess
from fractions import Fraction

import numpy as np
import pytest

from fogproof import analytic
from fogproof.cli import main
from fogproof.errors import InvalidInputError
from fogproof.golden import golden_entries, rows_of, to_c, to_csv, to_json_document, to_npz
from fogproof.quantities import quantities
from fogproof.scene.files import read_fields

NAMES = (
    "phase_pdf",
    "transmittance",
    "air_cross_section",
    "airlight_table",
    "coefficients",
    "rod_reflectance_orders",
    "free_path",
)

needs_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler: install gcc or clang")


@pytest.fixture(scope="module")
def entries():
    return golden_entries(NAMES)


@pytest.fixture(scope="module")
def numbers(entries):
    return [(row.value, row.error) for entry in entries for row in rows_of(entry)]


def test_every_number_answers_its_own_question(entries):
    """The arguments of a row, put to the oracle alone, give its value."""
    for entry in entries:
        rows = list(rows_of(entry))
        assert len(rows) == entry.value.size
        for row in rows[:: max(1, len(rows) // 12)]:
            arguments = read_fields(entry.quantity.arguments, row.arguments, "row")
            alone = entry.quantity.function(**arguments)
            value, error = np.broadcast_arrays(alone.value, alone.error)
            assert value.ndim == len(row.index)
            same = row.value == value[row.index]
            assert same or abs(row.value - value[row.index]) <= row.error + error[row.index]


def test_proven_values_are_rounded_honestly():
    entries = [entry for entry in golden_entries(["airlight_integral", "transmittance"]) if entry.digits]
    assert len(entries) > 100
    golden = {json.dumps(g.request): g for g in analytic.golden_values()}
    for entry in entries:
        proven = golden[json.dumps(entry.request)]
        off = abs(Fraction(float(entry.value)) - Fraction(proven.value)) + Fraction(proven.radius)
        assert off <= Fraction(float(entry.error))
        assert float(entry.error) <= math.ulp(float(entry.value)) / 2 + 2 * float(Fraction(proven.radius)) + 5e-324


def test_formats_agree(entries, numbers):
    document = json.loads(to_json_document(entries))
    assert set(document["quantities"]) == set(NAMES)
    found = [
        (float(value), float(error))
        for entry in document["values"]
        for value, error in zip(np.ravel(entry["value"]), np.ravel(entry["error"]), strict=True)
    ]
    assert found == numbers
    rows = list(csv.DictReader(io.StringIO(to_csv(entries))))
    assert [(float(row["value"]), float(row["error"])) for row in rows] == numbers
    assert all(row["unit"] == quantities()[row["quantity"]].unit for row in rows)
    with np.load(io.BytesIO(to_npz(entries)), allow_pickle=False) as archive:
        stems = [key.removesuffix("_value") for key in archive if key.endswith("_value")]
        packed = [
            pair for s in stems for pair in zip(archive[f"{s}_value"].flat, archive[f"{s}_error"].flat, strict=True)
        ]
        assert packed == numbers
        assert json.loads(str(archive["about"]))["quantities"]["phase_pdf"]["unit"] == "1/sr"
        assert archive["phase_pdf_0_mu"].tolist() == quantities()["phase_pdf"].example["mu"]


@needs_compiler
@pytest.mark.parametrize("compiler", [["cc", "-std=c99"], ["c++", "-std=c++11", "-x", "c++"]])
def test_the_header_compiles_and_holds_the_same_numbers(entries, numbers, compiler, tmp_path):
    if shutil.which(compiler[0]) is None:
        pytest.skip(f"no {compiler[0]}")
    header = to_c(entries)
    (tmp_path / "golden.h").write_text(header)
    loops = "".join(
        f"    for (size_t i = 0; i < fogproof_{name}_count; ++i)\n"
        f'        printf("%.17g %.17g\\n", fogproof_{name}_golden[i].value, fogproof_{name}_golden[i].error);\n'
        for name in NAMES
    )
    program = f'#include <stdio.h>\n#include "golden.h"\nint main(void) {{\n{loops}    return 0;\n}}\n'
    (tmp_path / "print.c").write_text(program)
    strict = ["-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    subprocess.run([*compiler, *strict, "print.c", "-o", "print"], cwd=tmp_path, check=True)
    out = subprocess.run([tmp_path / "print"], capture_output=True, text=True, check=True).stdout
    assert [tuple(map(float, line.split())) for line in out.splitlines()] == numbers
    for name in NAMES:
        head = "".join(quantities()[name].convention.replace("…", "...").split())
        assert head in "".join(header.split())


@needs_compiler
def test_the_header_of_every_quantity_compiles(tmp_path):
    entries = golden_entries(
        [name for name in quantities() if name not in ("radiance_by_ode", "sky_colour", "sun_colour")]
    )
    (tmp_path / "golden.h").write_text(to_c(entries))
    for standard in ("c89", "c99"):
        strict = [f"-std={standard}", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
        subprocess.run(["cc", *strict, "-fsyntax-only", "-x", "c", "golden.h"], cwd=tmp_path, check=True)


def test_a_header_survives_its_strings():
    phase = {
        "kind": "tabulated",
        "cosines": [-1, *np.linspace(-0.9, 0.9, 900).tolist(), 1],
        "values": [1 / (4 * np.pi)] * 902,
    }
    (entry,) = golden_entries([], [{"quantity": "phase_pdf", "phase": phase, "mu": 0, "id": '*/ ??/ \\ "'}])
    text = to_c([entry])
    assert "??" not in text
    assert max(map(len, text.splitlines())) < 4200


def test_the_command(tmp_path, capfdbinary):
    requests, table = tmp_path / "requests.jsonl", tmp_path / "table.csv"
    lines = [{"quantity": "phase_pdf", "phase": {"kind": "hazy"}, "mu": mu} for mu in (0.25, 0.5)]
    requests.write_text("\n".join(map(json.dumps, lines)))
    with pytest.raises(SystemExit, match="0"):
        main(["golden", "--requests", str(requests), "--format", "csv", "-o", str(table)])
    rows = list(csv.DictReader(io.StringIO(table.read_text())))
    assert [json.loads(row["arguments"])["mu"] for row in rows] == [0.25, 0.5]
    with pytest.raises(SystemExit, match="0"):
        main(["golden", "air_cross_section"])
    assert json.loads(capfdbinary.readouterr().out)["format"] == "fogproof/reference-values/1"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "name a QUANTITY"),
        (["luck"], "'luck' is not known"),
        (["--requests", "absent.jsonl"], "cannot read the request file absent.jsonl"),
        (["air_cross_section", "-o", "/proc/none/x"], "cannot write /proc/none/x"),
        (["air_cross_section", "--format", "xls"], "xls"),
    ],
)
def test_what_the_command_refuses(arguments, words, capfd):
    with pytest.raises(SystemExit, match="2"):
        main(["golden", *arguments])
    assert words in capfd.readouterr().err


def test_all_bad_requests_are_told_at_once(tmp_path, capfd):
    requests, output = tmp_path / "requests.jsonl", tmp_path / "table.json"
    good = {"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": 0}
    lines = [json.dumps(good), json.dumps({**good, "mu": 2}), "", "null", '{"quantity": "luck"}', "{", *["5"] * 20]
    requests.write_text("\n".join(lines))
    with pytest.raises(SystemExit, match="2"):
        main(["golden", "--requests", str(requests), "-o", str(output)])
    told = capfd.readouterr().err.splitlines()
    assert [int(line.partition(", line ")[2].partition(":")[0]) for line in told] == [2, 4, 5, 6, 7, 8, 9, 10, 11, 12]
    for line, words in zip(
        told, ("got 2.0", "got None", "'luck' is not known", "not valid JSON", "got 5"), strict=False
    ):
        assert words in line
    assert not output.exists()


def test_a_bad_request_is_named_with_its_line(tmp_path, capfd):
    requests = tmp_path / "requests.jsonl"
    requests.write_text('{"quantity": "air_cross_section", "wavelength": 5e-7}\n\n{"quantity": NaN}\n')
    with pytest.raises(SystemExit, match="2"):
        main(["golden", "--requests", str(requests)])
    assert "line 3: request has NaN" in capfd.readouterr().err
    with pytest.raises(InvalidInputError, match="not known"):
        golden_entries(["luck"])
