"""An environment: it brings luggage into a fleet, and ends when that is delivered."""
import sys

from peer import DONE, OPEN, Peer, topics

WAYS = [((3, 1), (3, 10)), ((5, 1), (5, 10)), ((8, 2), (2, 8))]


def block(place):
    return {"x": place[0], "y": place[1]}


def request(luggage, start, end):
    return {"robot": 0, "luggage": luggage, "stage": "REQUEST", "from": block(start), "to": block(end),
            "block": block(start)}


url, schemas = sys.argv[1:]
peer = Peer(url, "PythonEnvironment", topics(schemas), sends=["ETOPIC"], reads=["ELMSTOPIC"], vote=OPEN)
while not peer.is_read("ETOPIC"):
    list(peer.receive(0.1))
waiting = {number: request(number, *way) for number, way in enumerate(WAYS, 1)}
peer.send("ETOPIC", {"luggage": list(waiting.values()), "exceptional": [], "faults": []})
while waiting:
    for topic, component, said in peer.receive(0.1):
        if said["stage"] in ("DELIVERED", "GIVEN_UP") and waiting.pop(said["luggage"], None):
            print(f"luggage {said['luggage']} {said['stage']} by {component}", flush=True)
peer.vote = DONE
peer.leave()
