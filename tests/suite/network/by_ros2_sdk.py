"""A node of ROS 2 as rmw_zenoh makes it, by zenoh-ros2-sdk: it hears where robots are, brings luggage, and waits until
that is delivered. The hashes of types are those that the SDK makes of their definitions."""
import hashlib
import json
import re
import sys
import threading

from zenoh_ros2_sdk import ROS2Publisher, ROS2Subscriber
from zenoh_ros2_sdk.utils import compute_type_hash_from_msg

port, topics = int(sys.argv[1]), json.load(open(sys.argv[2]))
LINE = "=" * 80 + "\n"


def kind(topic):
    """The arguments that say what the type of a topic is."""
    name, text, description = topics[topic]
    own, *others = text.split(LINE)
    others = dict(re.fullmatch(r"MSG: (\S+)\n(.*)", one, re.S).groups() for one in others)
    others = {one.replace("/", "/msg/"): text for one, text in others.items()}
    known = compute_type_hash_from_msg(name, own, others)
    if "[<=" in text:
        # The SDK knows no lists with a bound.
        known = "RIHS01_" + hashlib.sha256(description.encode()).hexdigest()
    return {"msg_type": name, "msg_definition": text, "type_hash": known, "router_port": port}


def wait_for(event, what):
    if not event.wait(60):
        sys.exit(f"no {what}")


positions, has_position = {}, threading.Event()


def hear_position(message):
    positions[message.robot] = message.block
    has_position.set()


position = ROS2Subscriber("/POSTOPIC", callback=hear_position, **kind("POSTOPIC"))
wait_for(has_position, "position")
print("heard", sorted(positions), flush=True)

delivered, all_delivered = set(), threading.Event()


def hear_luggage(message):
    if message.stage == message.STAGE_DELIVERED:
        delivered.add(message.luggage)
        if len(delivered) == 2:
            all_delivered.set()


heard = ROS2Subscriber("/ELMSTOPIC", callback=hear_luggage, **kind("ELMSTOPIC"))
events = ROS2Publisher("/ETOPIC", **kind("ETOPIC"))
store = events.session_mgr.store
of = {name: store.types[f"saoms_msgs/msg/{name}"] for name in ("EventLuggage", "Block")}


def luggage(number, start, end):
    block = of["Block"]
    # `from` is a word of Python.
    return of["EventLuggage"](robot=0, luggage=number, stage=0, from_=block(*start), to=block(*end), block=block(0, 0))


other = ROS2Publisher("/ETOPIC", "saoms_msgs/msg/EnvironmentEvent", msg_definition=topics["ETOPIC"][1],
                      type_hash="RIHS01_" + "0" * 64, router_port=port)
other.publish(luggage=[], exceptional=[], faults=[])
events.publish(luggage=[luggage(1, (3, 1), (3, 10)), luggage(2, (5, 1), (5, 10))], exceptional=[], faults=[])
wait_for(all_delivered, "delivery")
print("delivered", sorted(delivered), flush=True)
for one in (position, heard, events, other):
    one.close()
