#!/usr/bin/env python3
"""Checks JUnit XML against the common form (that of Ant's task, which Jenkins, GitLab and Azure read), and prints it.

    check_junit.py FILE

Prints the suite as JSON; exit status 1 and a line on standard error for what does not conform.
"""
import json
import re
import sys
import xml.etree.ElementTree as ElementTree

# Attributes: required, then optional. Elements in the order that the schema wants.
SUITE = ({"name", "timestamp", "hostname", "tests", "failures", "errors", "time", "id", "package"}, {"skipped"})
CASE = ({"name", "classname", "time"}, set())
COMPLAINT = ({"type"}, {"message"})
ORDER = ["properties", "testcase", "system-out", "system-err"]


def require(condition, what):
    if not condition:
        sys.exit("check_junit: " + what)


def check_attributes(element, allowed):
    required, optional = allowed
    names = set(element.attrib)
    require(required <= names, "<%s> lacks %s" % (element.tag, sorted(required - names)))
    require(names <= required | optional, "<%s> has %s" % (element.tag, sorted(names - required - optional)))


def check_case(case):
    check_attributes(case, CASE)
    require(float(case.get("time")) >= 0, "a case takes negative time")
    require(len(case) <= 1, "a case has several outcomes")
    for outcome in case:
        require(outcome.tag in ("failure", "error", "skipped"), "<testcase> holds <%s>" % outcome.tag)
        check_attributes(outcome, (set(), {"message"}) if outcome.tag == "skipped" else COMPLAINT)
    outcome = case[0] if len(case) else None
    return {"name": case.get("name"), "classname": case.get("classname"), "time": float(case.get("time")),
            "outcome": "passed" if outcome is None else outcome.tag,
            "type": None if outcome is None else outcome.get("type"),
            "message": None if outcome is None else outcome.get("message"),
            "text": None if outcome is None else outcome.text}


def check_suite(suite):
    check_attributes(suite, SUITE)
    require(re.fullmatch(r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d", suite.get("timestamp")), "the timestamp has no ISO form")
    tags = [child.tag for child in suite]
    require(tags == sorted(tags, key=ORDER.index), "the elements of the suite are out of order")
    for single in ("properties", "system-out", "system-err"):
        require(tags.count(single) == 1, "there is not one <%s>" % single)
    for one in suite.find("properties"):
        require(one.tag == "property" and set(one.attrib) == {"name", "value"}, "a property lacks name or value")
    cases = [check_case(case) for case in suite.findall("testcase")]
    counts = {"tests": len(cases)}
    for attribute, outcome in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        counts[attribute] = sum(case["outcome"] == outcome for case in cases)
    for attribute, count in counts.items():
        require(int(suite.get(attribute)) == count, "%s=%s, but there are %d" % (attribute, suite.get(attribute), count))
    return {"counts": counts, "cases": cases, "out": suite.find("system-out").text or "",
            "properties": {one.get("name"): one.get("value") for one in suite.find("properties")}}


def main():
    root = ElementTree.parse(sys.argv[1]).getroot()
    require(root.tag == "testsuites" and len(root) == 1 and root[0].tag == "testsuite", "not one suite in <testsuites>")
    print(json.dumps(check_suite(root[0])))


if __name__ == "__main__":
    main()
