#!/usr/bin/env python3
"""Fits how sure it is that a place that scans have found is the right one ([tuning.find_evidence]).

    isthmus-campaign evidence --wild --seeds 60 --from 3001 --output closures.csv --finds finds.csv
    tools/fit_evidence.py finds.csv

Logistic regression (Newton's method) of whether the robot was there on the score of the search, on that of the scan that
carries the relations, on how much of what way and place show one another both saw, and on whether anything said where to
look. Finds at one of several places that look alike are left
out: the way before them tells which it is. Each run is also predicted by a fit to all the others, and the table says how
many finds of what log-odds are true.
"""

import argparse
import csv
import math
import sys

NAMES = ("against_no_score", "per_search_score", "per_carrier_score", "per_seen_again", "against_anywhere")
SIGNS = (-1, 1, 1, 1, -1)
EDGES = (-math.inf, -2, -1, 0, 1, 2, 3, 5, math.inf)


def solve(matrix, right):
    """Gaussian elimination with pivoting."""
    rows = [list(row) + [value] for row, value in zip(matrix, right)]
    size = len(rows)
    for i in range(size):
        pivot = max(range(i, size), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for k in range(i + 1, size):
            factor = rows[k][i] / rows[i][i]
            for j in range(i, size + 1):
                rows[k][j] -= factor * rows[i][j]
    result = [0.0] * size
    for i in reversed(range(size)):
        result[i] = (rows[i][size] - sum(rows[i][j] * result[j] for j in range(i + 1, size))) / rows[i][i]
    return result


def log_odds(weights, features):
    return sum(weight * value for weight, value in zip(weights, features))


def fit(features, labels, ridge=1e-3, steps=50):
    size = len(features[0])
    weights = [0.0] * size
    for _ in range(steps):
        gradient = [-ridge * weight for weight in weights]
        hessian = [[ridge if i == j else 0.0 for j in range(size)] for i in range(size)]
        for values, label in zip(features, labels):
            share = 1 / (1 + math.exp(-log_odds(weights, values)))
            for i in range(size):
                gradient[i] += (label - share) * values[i]
                for j in range(size):
                    hessian[i][j] += share * (1 - share) * values[i] * values[j]
        step = solve(hessian, gradient)
        weights = [weight + change for weight, change in zip(weights, step)]
        if max(map(abs, step)) < 1e-9:
            break
    return weights


def load(files):
    runs, features, labels = [], [], []
    for name in files:
        with open(name, newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                if int(row["look_alikes"]) > 1:
                    continue
                anywhere = 1.0 if float(row["way_m"]) == 0 else 0.0
                runs.append((name, row["run"]))
                shown = [float(row[name]) for name in ("search_score", "carrier_score", "seen_again")]
                features.append([1.0, *shown, anywhere])
                labels.append(int(row["true"]))
    return runs, features, labels


def predicted_by_the_others(runs, features, labels):
    predicted = [0.0] * len(runs)
    for left_out in sorted(set(runs)):
        others = [i for i, run in enumerate(runs) if run != left_out]
        weights = fit([features[i] for i in others], [labels[i] for i in others])
        for i, run in enumerate(runs):
            if run == left_out:
                predicted[i] = log_odds(weights, features[i])
    return predicted


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("finds", nargs="+", metavar="FILE", help="tables of isthmus-campaign evidence --finds")
    arguments = parser.parse_args()
    try:
        runs, features, labels = load(arguments.finds)
    except (OSError, KeyError, ValueError) as error:
        print(f"fit_evidence.py: {error}", file=sys.stderr)
        return 1
    if not 0 < sum(labels) < len(labels):
        print("fit_evidence.py: it takes true finds and false ones", file=sys.stderr)
        return 1
    print(f"{len(labels)} finds of {len(set(runs))} runs, {sum(labels)} of them true\n\n[tuning]")
    for name, sign, weight in zip(NAMES, SIGNS, fit(features, labels)):
        print(f"find_evidence.{name} = {sign * weight:.1f}")
    print("\n| log-odds by the other runs | true | false |\n|---|---|---|")
    predicted = predicted_by_the_others(runs, features, labels)
    for low, high in zip(EDGES, EDGES[1:]):
        within = [label for value, label in zip(predicted, labels) if low <= value < high]
        print(f"| {low:g} to {high:g} | {sum(within)} | {len(within) - sum(within)} |")
    return 0


if __name__ == "__main__":
    sys.exit(main())
