"""The stated model refitted: a mismatch where the chi2 held out exceeds 1.08; no name, ever."""

import sys

from asked import answer, identify

FLAGGED = 1.08


def diagnose(path):
    fitted = identify(path)
    left = ((fitted or {}).get("holdout") or {}).get("chi2") or float("inf")
    return {"verdict": "mismatch" if left > FLAGGED else "consistent"}


if __name__ == "__main__":
    sys.exit(answer("refit of the stated model", diagnose))
