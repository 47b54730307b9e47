"""The fleet in virtual time: `python3 -m unittest`. `SAOMS` names the command, where it is not in PATH."""
import json
import os
import subprocess
import unittest

SAOMS = os.environ.get("SAOMS", "saoms")
HERE = os.path.dirname(os.path.abspath(__file__))


def saoms(*arguments):
    done = subprocess.run([SAOMS, *arguments], cwd=HERE, capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stdout + done.stderr)
    return done.stdout


class Fleet(unittest.TestCase):
    def test_it_is_without_a_fault(self):
        saoms("check", "fleet.composite")

    def test_it_counts(self):
        run = saoms("run", "fleet.composite", "--plugin", ".", "--virtual", "--for", "10s", "--quiet", "--report", "-")
        self.assertEqual(json.loads(run)["count"]["number"], 10)


if __name__ == "__main__":
    unittest.main()
