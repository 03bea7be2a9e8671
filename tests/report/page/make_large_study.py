#!/usr/bin/env python3
"""Makes a large study's folder in seconds, to try pages and tables on. SYNTHETIC: no cell was ever run; every number in
its cell.json is drawn, and the folder says so (study.toml's title, the file SYNTHETIC).

    make_large_study.py ARMWRIGHT FOLDER [OPTIMIZERS [REPLICATES [PROBLEM ...]]]

The plan is a real one, resolved by `ARMWRIGHT compare --dry-run`: optimizers `random`, `cmaes`, `ga`, ... under made-up
labels, on functions or arms (default: q1-complex, q2-e6, sphere, q2-pareto), a budget of a million evaluations. There are
no journals, and no results but cell.json."""
import json
import math
import os
import random
import subprocess
import sys
import tomllib

BASES = ['ga', 'cmaes', 'nlopt:bobyqa', 'nlopt:sbplx', 'pagmo:sade', 'pagmo:pso_gen', 'random', 'lhs']


def escape(name):
    plain = lambda i, c: c.isascii() and (c.isalnum() or c in '_-' or (c == '.' and i > 0))
    return ''.join(c if plain(i, c) else ''.join(f'%{b:02X}' for b in c.encode()) for i, c in enumerate(name))


def write_plan(file, optimizers, replicates, problems):
    lines = ['title = "SYNTHETIC: drawn numbers, nothing was run"', f'problems = {json.dumps(problems)}',
             f'replicates = {replicates}', 'budget = 1000000', 'schedule = "fixed:1"', 'baselines = false',
             'final_engine = ""']
    for i in range(optimizers):
        base = BASES[i % len(BASES)]
        lines += ['[[optimizer]]', f'name = "{base}"', f'label = "{base} no. {i + 1}"']
    with open(file, 'w') as out:
        out.write('\n'.join(lines) + '\n')


def resolve(program, folder, plan):
    words = [program, 'compare', plan, '--dry-run', '--quiet', '--out', folder]
    return subprocess.run(words, check=True, capture_output=True, text=True).stdout


def get_checkpoints(budget, count):
    return sorted({min(max(round(budget ** (i / (count - 1))), 1), budget) for i in range(count)})


def describe(program, problem):
    words = [program, 'list', 'problems', problem, '--json']
    return json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)


# Within the bounds, near the start, the sign kept: designs that can be simulated.
def draw_design(rng, variables):
    return [one['start'] * math.exp(rng.uniform(-0.3, 0.3)) if one['start'] else rng.uniform(one['lower'], one['upper'])
            for one in variables]


def draw_cell(rng, problem, optimizer, strength, replicate, checkpoints, variables, objectives, budget):
    level = math.exp(rng.gauss(strength, 0.4))
    failed = rng.random() < 0.01
    curve = []
    for budget_here in checkpoints:
        left = math.exp(-strength_of(budget_here, budget) * (3 - strength))
        curve.append([budget_here, level * (1 + 50 * left)])
    value = None if failed else level
    front = []
    if objectives > 1 and not failed:
        width = rng.uniform(0.5, 1.5)
        front = [[level * 0.01 * (1 + 5 * (i / 40)), 2e4 * width / (1 + i)] for i in range(45)]
    return {
        'format': 1, 'problem': problem['label'], 'label': optimizer['label'], 'optimizer': optimizer['name'],
        'replicate': replicate, 'configuration_sha256': problem['configuration_sha256'], 'end_reason': 'budget',
        'failure': '', 'evaluations': budget, 'cases': budget, 'clipped': 0, 'failed_evaluations': 0,
        'x': draw_design(rng, variables), 'validation_value': value, 'value': value,
        'violation': 0.0,
        'test': {'cases': 500, 'without_number': 1 if failed else 0, 'failures': 1 if failed else 0, 'mean': level,
                 'median': level, 'percentile_95': 2 * level, 'worst': None if failed else 3 * level},
        'objectives': [level] * objectives, 'metrics': [], 'start_value': 51 * math.exp(2), 'curve': curve,
        'front': front,
    }


def strength_of(budget_here, budget):
    return math.log(budget_here) / math.log(budget)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    program, folder = os.path.abspath(sys.argv[1]), os.path.abspath(sys.argv[2])
    optimizers = int(sys.argv[3]) if len(sys.argv) > 3 else 40
    replicates = int(sys.argv[4]) if len(sys.argv) > 4 else 15
    problems = sys.argv[5:] or ['q1-complex', 'q2-e6', 'sphere', 'q2-pareto']
    os.makedirs(folder)
    plan_file = os.path.join(folder, 'SYNTHETIC')
    write_plan(plan_file, optimizers, replicates, problems)
    text = resolve(program, folder, plan_file)
    with open(os.path.join(folder, 'study.toml'), 'w') as out:
        out.write(text)
    plan = tomllib.loads(text)
    checkpoints = get_checkpoints(plan['budget'], plan['checkpoints'])
    for problem in plan['problem']:
        shape = describe(program, problem['name'])
        for number, optimizer in enumerate(plan['optimizer']):
            rng = random.Random(f"{problem['label']}/{optimizer['label']}")
            strength = rng.uniform(-1, 2)
            for replicate in range(1, replicates + 1):
                where = os.path.join(folder, 'cells', escape(problem['label']), escape(optimizer['label']),
                                     f'r{replicate:02}')
                os.makedirs(where)
                cell = draw_cell(rng, problem, optimizer, strength, replicate, checkpoints,
                                 shape['variables'], len(shape['objectives']), plan['budget'])
                with open(os.path.join(where, 'cell.json'), 'w') as out:
                    json.dump(cell, out)


if __name__ == '__main__':
    main()
