"""A DC motor turns a load through a flexible shaft by 1 rad. A position controller (P) sets the speed of
a speed controller (PI), whose torque is limited. The controllers' three gains are tuned: the integral of
time times absolute error (ITAE) of the load shall be small, and its overshoot at most 2 %.

    armwright optimize 'exec:/usr/bin/python3 motor.py' --optimizer cmaes --budget 300
"""
import json
import sys

import numpy
from scipy.integrate import solve_ivp

MOTOR_KG_M2, LOAD_KG_M2, STIFFNESS_N_M_PER_RAD, DAMPING_N_M_S = 0.01, 0.02, 40.0, 0.02
LIMIT_N_M, END_S = 2.0, 1.5

DESCRIPTION = {
    "type": "problem", "protocol": 1, "name": "dc-motor",
    "summary": "Cascaded control of a DC motor with a flexible shaft",
    "variables": [
        {"name": "kp_position", "unit": "1/s", "lower": 1, "upper": 100, "scale": "logarithmic"},
        {"name": "kp_speed", "unit": "N m s", "lower": 0.01, "upper": 10, "scale": "logarithmic"},
        {"name": "ki_speed", "unit": "N m", "lower": 0.01, "upper": 100, "scale": "logarithmic"}],
    "objectives": [{"name": "itae", "unit": "rad s2"}],
    "constraints": [{"name": "overshoot", "unit": "rad", "limit": 0.02}],
    "metrics": [{"name": "peak_torque", "unit": "N m"}],
}


def simulate(kp_position, kp_speed, ki_speed):
    def calc_torque(motor, speed, integral):
        slip = kp_position * (1 - motor) - speed
        wanted = kp_speed * slip + ki_speed * integral
        torque = numpy.clip(wanted, -LIMIT_N_M, LIMIT_N_M)
        return torque, slip + (torque - wanted) / kp_speed  # at the limit, the integral follows the torque

    def derive(t, state):
        motor, speed, load, load_speed, integral, _ = state
        torque, growth = calc_torque(motor, speed, integral)
        shaft = STIFFNESS_N_M_PER_RAD * (motor - load) + DAMPING_N_M_S * (speed - load_speed)
        return [speed, (torque - shaft) / MOTOR_KG_M2, load_speed, shaft / LOAD_KG_M2, growth,
                t * abs(1 - load)]

    found = solve_ivp(derive, (0, END_S), numpy.zeros(6), method="LSODA", rtol=1e-6, atol=1e-9, max_step=0.005)
    if not found.success:
        return {"status": "diverged", "reason": found.message}
    motor, speed, load, _, integral, itae = found.y
    torque, _ = calc_torque(motor, speed, integral)
    return {"objectives": [itae[-1]], "constraints": [max(load.max() - 1, 0)], "metrics": [abs(torque).max()]}


for line in sys.stdin:
    message = json.loads(line)
    if message["type"] == "hello":
        print(json.dumps(DESCRIPTION), flush=True)
    elif message["type"] == "evaluate":
        answers = [simulate(*point) for point in message["points"]]
        print(json.dumps({"type": "answers", "id": message["id"], "answers": answers}), flush=True)
