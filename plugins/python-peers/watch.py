"""Follows the positions of robots. It takes no part: it says nothing, nobody waits for it, and it may miss some."""
import sys
import time

from cdr import decode
from peer import join, topics

url, schemas = sys.argv[1:]
position = topics(schemas)["POSTOPIC"][1]


def show(sample):
    said = decode(position, sample.payload)
    print(f"robot {said['robot']} is at ({said['block']['x']},{said['block']['y']})", flush=True)


session = join(url)
session.declare_subscriber("saoms/2/topic/POSTOPIC/**", show)
print("listens", flush=True)
while True:
    time.sleep(1)
