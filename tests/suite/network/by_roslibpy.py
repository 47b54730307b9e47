"""A program with roslibpy: it hears where robots are, brings luggage, and waits until that is delivered."""
import json
import sys
import threading

import roslibpy
from roslibpy.comm.comm import RosBridgeProtocol

port = int(sys.argv[1])
ros = roslibpy.Ros(host="127.0.0.1", port=port)
ros.run(20)


def wait_for(event, what):
    if not event.wait(60):
        sys.exit(f"no {what}")


# roslibpy has no handler for what a server refuses.
refused, refusal = [], threading.Event()
usual = RosBridgeProtocol.on_message


def on_message(self, payload):
    said = json.loads(payload.decode("utf8"))
    if said["op"] != "status":
        return usual(self, payload)
    refused.append(said["msg"])
    refusal.set()


RosBridgeProtocol.on_message = on_message

positions, has_position = {}, threading.Event()


def hear_position(message):
    positions[message["robot"]] = message["block"]
    has_position.set()


roslibpy.Topic(ros, "/POSTOPIC", "saoms_msgs/msg/Position").subscribe(hear_position)
wait_for(has_position, "position")
print("heard", sorted(positions), flush=True)

topics = dict(zip(*[ros.get_topics(), [ros.get_topic_type(name) for name in ros.get_topics()]]))
print("POSTOPIC is", topics["/POSTOPIC"], flush=True)

delivered, all_delivered = set(), threading.Event()
DELIVERED = 4


def hear_luggage(message):
    if message["stage"] == DELIVERED:
        delivered.add(message["luggage"])
        if len(delivered) == 2:
            all_delivered.set()


roslibpy.Topic(ros, "/ELMSTOPIC", "saoms_msgs/EventLuggage").subscribe(hear_luggage)
events = roslibpy.Topic(ros, "/ETOPIC", "saoms_msgs/EnvironmentEvent")
events.advertise()


def luggage(number, start, end):
    return {"luggage": number, "from": {"x": start[0], "y": start[1]}, "to": {"x": end[0], "y": end[1]}}


# A name that no field has, and a type that the topic does not have.
events.publish(roslibpy.Message({"luggages": []}))
wait_for(refusal, "refusal")
print("refused:", refused[0], flush=True)
refusal.clear()
roslibpy.Topic(ros, "/ETOPIC", "std_msgs/String").advertise()
wait_for(refusal, "refusal")
print("refused:", refused[1], flush=True)

# What is left out is 0 or empty.
events.publish(roslibpy.Message({"luggage": [luggage(1, (3, 1), (3, 10)), luggage(2, (5, 1), (5, 10))]}))
wait_for(all_delivered, "delivery")
print("delivered", sorted(delivered), flush=True)
ros.terminate()
