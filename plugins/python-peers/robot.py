"""A robot: it brings what a master assigns to it, and waits at its charger. It enters no block that another one wants."""
import sys

from peer import Peer, topics

PERIOD = 0.1  # seconds
FIRST = {"rank": 2**64 - 1, "robot": 0}  # the priority of a robot that never makes way

url, schemas, number = sys.argv[1:]
number = int(number)
peer = Peer(url, f"PythonRobot{number}", topics(schemas), sends=["RLMSTOPIC", "POSTOPIC", "ELMSTOPIC"],
            reads=["JOBTOPIC", "POSTOPIC"])
charger = at = wanted = {"x": 0, "y": number}
job, carries, others = None, False, {}


def say_state(active=True):
    peer.send("RLMSTOPIC", {"robot": number, "active": active, "battery": 100.0, "in_charge": False, "asleep": False,
                            "charger": charger, "period": int(PERIOD * 1e6), "block": at, "policy": "SAFE",
                            "began": None})


def say_position(following):
    peer.send("POSTOPIC", {"robot": number, "block": at, "next": following, "wanted": wanted, "priority": FIRST})


def answer(order, stage):
    print(f"luggage {order['luggage']} {stage} at ({at['x']},{at['y']})", flush=True)
    peer.send("ELMSTOPIC", {"robot": number, "luggage": order["luggage"], "stage": stage, "from": order["from"],
                            "to": order["to"], "block": at})


def toward(goal):
    axis = "x" if at["x"] != goal["x"] else "y"
    return {**at, axis: at[axis] + (goal[axis] > at[axis]) - (goal[axis] < at[axis])}


say_position(at)
say_state()
while not peer.is_over():
    for topic, component, said in peer.receive(PERIOD):
        if topic == "POSTOPIC":
            others[said["robot"]] = said
        elif said["robot"] == number and (job is None or said["withdrawn"]):
            if said["withdrawn"] and (job is None or carries or job["luggage"] != said["luggage"]):
                continue
            job = None if said["withdrawn"] else said
            answer(said, "RELEASE" if said["withdrawn"] else "TAKEN")
    if job and not carries and at == job["from"]:
        carries = True
    elif carries and at == job["to"]:
        answer(job, "DELIVERED")
        job, carries = None, False
    if wanted != at and not any(wanted in (one["block"], one["next"], one["wanted"]) for one in others.values()):
        say_position(wanted)
        at = wanted
        say_state()
        continue
    wanted = toward((job["to"] if carries else job["from"]) if job else charger)
    say_position(at)
say_state(active=False)
peer.leave()
