"""Plain Bayesian optimization as a plugin for armwright: one Gaussian process of scikit-learn over the
whole box, and the point with the largest expected improvement (Jones, Schonlau and Welch 1998, Efficient
global optimization of expensive black-box functions), one evaluation at a time.

    armwright optimize branin --optimizer 'exec:/usr/bin/python3 expected_improvement.py' --opt design=FILE

The option `design` names a JSON file with the list of points that are evaluated first. The process has a
Matern 5/2 kernel with one length scale per variable, and normalised values. Its hyperparameters maximise the
marginal likelihood: after every evaluation from those of the last fit, and every tenth time also from two
random ones. The logarithm of the expected improvement is evaluated at 2000 random places and maximised from
the best four and from the incumbent by L-BFGS-B. Needs scikit-learn (Debian: python3-sklearn).
"""
import json
import os
import sys

PROTOCOL = 1

DESCRIPTION = {
    "type": "description",
    "protocol": PROTOCOL,
    "name": "gp-ei",
    "summary": "One Gaussian process of scikit-learn and its expected improvement",
    "source": "Jones, Schonlau and Welch 1998, Efficient global optimization of expensive black-box functions",
    "capabilities": ["bounds", "batch", "stochastic"],
    "options": [
        {"name": "design", "description": "JSON file with the points that are evaluated first", "default": ""},
    ],
}


# SciPy's Fortran code prints notes to file descriptor 1. They go to standard error; the protocol has its own copy.
protocol = os.fdopen(os.dup(1), "w", encoding="utf-8")
os.dup2(2, 1)


class Stopped(Exception):
    """Raised when the host evaluates no more points."""


def send(message):
    try:
        protocol.write(json.dumps(message) + "\n")
        protocol.flush()
    except BrokenPipeError:
        os._exit(0)  # the host has ended


def receive():
    line = sys.stdin.readline()
    if not line:
        sys.exit(0)  # the host has ended
    return json.loads(line)


def minimize(task):
    import warnings

    import numpy as np  # imported here so that the description is sent without delay
    from scipy.optimize import minimize as descend
    from scipy.stats import norm
    from sklearn.exceptions import ConvergenceWarning
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern

    warnings.simplefilter("ignore", ConvergenceWarning)
    variables = task["problem"]["variables"]
    lower = np.array([v["lower"] for v in variables])
    upper = np.array([v["upper"] for v in variables])
    n = len(variables)
    random = np.random.default_rng(task["seed"])

    def evaluate(points):
        send({"type": "ask", "points": [p.tolist() for p in points]})
        answer = receive()
        if answer["stopped"]:
            raise Stopped
        return [score["objectives"][0] for score in answer["scores"]]

    with open(task["options"]["design"]) as file:
        design = [np.array(point) for point in json.load(file)]
    try:
        y = evaluate(design)
    except Stopped:
        send({"type": "done"})
        return
    u = [(point - lower) / (upper - lower) for point in design]
    kernel = ConstantKernel(1.0, (1e-3, 1e3)) * Matern(np.full(n, 0.5), (1e-2, 1e2), nu=2.5)
    while True:
        restarts = 2 if len(y) % 10 == 0 else 0
        values = np.array(y)
        for alpha in (1e-10, 1e-8, 1e-6):
            try:
                process = GaussianProcessRegressor(kernel, alpha=alpha, normalize_y=True,
                                                   n_restarts_optimizer=restarts,
                                                   random_state=int(random.integers(2**31)))
                process.fit(np.array(u), values)
                break
            except np.linalg.LinAlgError:
                if alpha == 1e-6:
                    raise
        kernel = process.kernel_
        best = values.min()

        def calc_log_improvement(places):
            mean, deviation = process.predict(places, return_std=True)
            deviation = np.maximum(deviation, 1e-12 * values.std())
            z = (best - mean) / deviation
            # log(phi(z) + z Phi(z)); for very negative z by its asymptote phi(z) / z^2
            with np.errstate(divide="ignore", invalid="ignore"):
                inner = np.log(norm.pdf(z) + z * norm.cdf(z))
            far = norm.logpdf(z) - 2 * np.log(np.maximum(np.abs(z), 1))
            return np.log(deviation) + np.where((z < -6) | ~np.isfinite(inner), far, inner)

        step = 1e-7

        def calc_loss(place):
            shifted = np.vstack([place, place + step * np.eye(n)])
            value = -calc_log_improvement(shifted)
            return value[0], (value[1:] - value[0]) / step

        places = random.random((2000, n))
        order = np.argsort(-calc_log_improvement(places))
        starts = [places[k] for k in order[:4]] + [u[int(values.argmin())]]
        found = [descend(calc_loss, start, jac=True, method="L-BFGS-B", bounds=[(0, 1)] * n,
                         options={"maxiter": 50}) for start in starts]
        chosen = np.clip(min(found, key=lambda one: one.fun).x, 0, 1)
        point = np.clip(lower + chosen * (upper - lower), lower, upper)
        try:
            y += evaluate([point])
        except Stopped:
            break
        u.append(chosen)
    send({"type": "done"})


def main():
    hello = receive()
    if hello.get("protocol") != PROTOCOL:
        print(f"speaks protocol {PROTOCOL}, armwright speaks {hello.get('protocol')}", file=sys.stderr)
    send(DESCRIPTION)
    task = receive()
    if task["type"] == "minimize":
        minimize(task)


main()
