"""`junit.xml`: a run as continuous integration systems read it.

rejected, surprise    <failure> with the verdict in words; so is a broken twin that was not rejected
error                 <error>
skipped               <skipped> with the reason (what to install)
inconclusive          <skipped>: nothing was shown wrong, and nothing right either, so it is no pass
not run               <skipped>: the run was stopped before it came to it
passed, known         a pass; a known finding says so in <system-out>
"""

from __future__ import annotations

from pathlib import Path
from xml.etree import ElementTree

from fogproof.reports.pages.summaries import blind
from fogproof.reports.records.runs import Case, RunRecord
from fogproof.text import visible
from fogproof.whole_files import write_file


def write_junit(run: RunRecord, folder: str | Path) -> Path:
    """Write `folder/junit.xml` and return its path. Names may hold anything: what XML cannot say is made visible."""
    name = f"fogproof {run.kind}" + (f", {run.unfinished}" if run.unfinished else "")
    suite = ElementTree.Element("testsuite", name=visible(name), timestamp=visible(run.started))
    properties = ElementTree.SubElement(suite, "properties")
    for name, value in {"seed": run.seed, "alpha": run.alpha, "fogproof": run.fogproof, **run.environment}.items():
        ElementTree.SubElement(properties, "property", name=visible(str(name)), value=visible(str(value)))
    outcomes = [_add(suite, run, case) for case in run.cases] + [_add_missing(suite, run, n) for n in run.missing]
    counts = {"tests": len(outcomes), "time": f"{run.seconds:.3f}"}
    counts |= {f"{tag}s" if tag != "skipped" else tag: outcomes.count(tag) for tag in ("failure", "error", "skipped")}
    suite.attrib.update({name: str(value) for name, value in counts.items()})
    suites = ElementTree.Element("testsuites")
    suites.append(suite)
    ElementTree.indent(suites)
    return write_file(Path(folder) / "junit.xml", ElementTree.tostring(suites, "utf-8", xml_declaration=True))


def _add(suite: ElementTree.Element, run: RunRecord, case: Case) -> str:
    """Add one test case and return the tag that tells its outcome, "" for a pass."""
    test = ElementTree.SubElement(
        suite,
        "testcase",
        classname=f"fogproof.{run.kind}.{case.kind}",
        name=visible(case.name),
        time=f"{case.seconds:.3f}",
    )
    tags = {
        "rejected": "failure",
        "surprise": "failure",
        "error": "error",
        "skipped": "skipped",
        "inconclusive": "skipped",
    }
    tag = "failure" if blind(case) else tags.get(case.status, "")
    words = visible(explain(case))
    if tag:
        message = words.partition("\n")[0]
        ElementTree.SubElement(test, tag, message=message, type=case.status).text = words
    elif case.status == "known":
        ElementTree.SubElement(test, "system-out").text = visible(f"known finding: {case.reason}\n{explain(case)}")
    return tag


def _add_missing(suite: ElementTree.Element, run: RunRecord, name: str) -> str:
    test = ElementTree.SubElement(suite, "testcase", classname=f"fogproof.{run.kind}", name=visible(name), time="0.000")
    ElementTree.SubElement(test, "skipped", message="not run: the run was stopped before it", type="gone")
    return "skipped"


def explain(case: Case) -> str:
    """Return why the case ended as it did: the catalogue's word about it, the verdict, and how to see it again."""
    lines = []
    if case.status == "surprise":
        lines.append(f"expected {case.expected}" + (f" ({case.reason})" if case.reason else ""))
    elif case.verdict is None or case.status == "error":
        lines.append(case.reason or case.status)
    if case.verdict is not None:
        lines.append(str(case.verdict))
    if case.twin_result and blind(case):
        why = case.twin_result.reason
        lines.insert(0, f"broken twin ({case.twin}): {case.twin_result.outcome}" + (f"; {why}" if why else ""))
    if (case.status not in ("passed", "skipped") or blind(case)) and case.reproduce:
        lines.append(f"reproduce: {case.reproduce}")
    return "\n".join(lines)
