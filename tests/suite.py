"""Runs the tests of one class, or a part of them, and ends with lines like cmocka's, which scripts/test counts."""
import sys
import unittest


def run(case, share="0/1"):
    """share: PART/PARTS, as 0/3 for every third test from the first on. Returns the exit code."""
    part, parts = map(int, share.split("/"))
    tests = list(unittest.defaultTestLoader.loadTestsFromTestCase(case))
    result = unittest.TextTestRunner(stream=sys.stdout, verbosity=2).run(unittest.TestSuite(tests[part::parts]))
    failed, skipped = len(result.failures) + len(result.errors), len(result.skipped)
    print("[  PASSED  ] %d test(s)." % (result.testsRun - failed - skipped))
    if skipped:
        print("[  SKIPPED ] %d test(s), listed above." % skipped)
    if failed:
        print("[  FAILED  ] %d test(s), listed above." % failed)
    return 1 if failed else 0
