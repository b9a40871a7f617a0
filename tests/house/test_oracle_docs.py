"""docs/oracle.md: its tables are those of the quantities and kinds there are, and its requests are answered as it says."""

import json
import re
from pathlib import Path

import numpy as np
from write_oracle_docs import FILE, document

from fogproof.analytic import transmittance
from fogproof.errors import FogproofError
from fogproof.oracle import answer, answer_text
from fogproof.oracle.answers import to_json
from fogproof.scene import Medium, Ray

PAGE = FILE.read_text(encoding="utf-8")
BLOCKS = [json.loads(block) for block in re.findall(r"```json\n(.*?)\n```", PAGE, re.DOTALL)]


def test_the_tables_are_current():
    assert document(PAGE) == PAGE, "run: python tools/write_oracle_docs.py"


def test_the_request_shown_has_the_answer_shown():
    request, shown = BLOCKS
    found = json.loads(to_json(answer_text(json.dumps(request))))
    assert set(shown) == set(found)
    assert (shown["protocol"], shown["id"], shown["unit"]) == (found["protocol"], found["id"], found["unit"])
    truth = transmittance(Medium(0.1, 0.4), Ray((0, 0, 0), (0, 0, 1), [1, 2]))
    np.testing.assert_allclose(found["value"], truth.value, rtol=1e-15)
    np.testing.assert_allclose(shown["value"], truth.value, rtol=1e-8)
    assert np.all(np.array(shown["error"]) >= truth.error)


def test_every_code_is_explained():
    codes = {cls.code for cls in FogproofError.__subclasses__() if cls.__module__ == "fogproof.errors"} - {
        "subject-failed",
        "rejected",
        "inconclusive",
    }
    assert codes <= set(re.findall(r"^\| `([a-z-]+)` \| ", PAGE, re.MULTILINE))


def test_the_command_of_the_page_is_answered():
    (text,) = re.findall(r"echo '(.*?)' \| fogproof oracle -", PAGE)
    assert answer(json.loads(text))["value"] > 0


def test_links_lead_somewhere():
    for link in re.findall(r"\]\((\.\./[^)]+)\)", PAGE):
        assert (Path(FILE).parent / link).exists(), link
