"""A program of a fleet: what docs/python-peers.md asks of one that misses nothing, and of which nothing is missed."""
import json
import os
import queue
import random
import time
from collections import defaultdict

import zenoh

from cdr import decode, encode, message, schema_hash

PATIENCE = 2.0  # seconds without a sign of life after which others miss this program
INTERVAL = 0.2  # seconds between two signs of life
SILENT, OPEN, DONE = range(3)  # votes

ENCLOSED = message(size="uint32", to="string", key="uint64", has_key="bool", sent="uint64", cause="uint64")
IN_CELL = message(x="int32", y="int32", before="uint64", has_left="bool")
ENVELOPE = message(program="uint64", component="string", schema="uint64", number="uint64",
                   messages={"sequence": ENCLOSED}, cells={"sequence": IN_CELL})
CHANGE = message(x="int32", y="int32", last="uint64")
SENDS = message(topic="string", is_state="bool", last="uint64", oldest="uint64", before="uint64", by_cells="bool",
                since="uint64", cells={"sequence": CHANGE})
READS = message(topic="string")
RECEIVED = message(program="uint64", topic="string", next="uint64")
WELCOME = message(reader="uint64", topic="string", first="uint64")
ALIVE = message(program="uint64", origin="uint64", start="uint64", began="uint64", name="string", number="uint64",
                patience="uint64", sends={"sequence": SENDS}, reads={"sequence": READS},
                received={"sequence": RECEIVED}, welcomes={"sequence": WELCOME}, vote="uint8", leaves="bool")
AGAIN = message(reader="uint64", topic="string", first="uint64", last="uint64")
COVERED = message(program="uint64", topic="string", first="uint64", last="uint64", numbers={"sequence": "uint64"})


def topics(file):
    """The kind, the schema and its hash of each topic, from what `saoms components --format json` printed."""
    with open(file) as text:
        classes = json.load(text)
    ends = [end for one in classes["components"] + classes["loops"] for end in one["publishes"] + one["subscribes"]]
    return {end["topic"]: (end["kind"], end["schema"], schema_hash(end["schema"])) for end in ends}


def join(url):
    """A session of Zenoh at the broker of a fleet, with the account that is in the environment, if there is one."""
    config = zenoh.Config()
    settings = {"mode": "client", "connect/endpoints": ["tcp/" + url], "scouting/multicast/enabled": False}
    if "SAOMS_USER" in os.environ:
        settings["transport/auth/usrpwd/user"] = os.environ["SAOMS_USER"]
        settings["transport/auth/usrpwd/password"] = os.environ["SAOMS_PASSWORD"]
    for name, value in settings.items():
        config.insert_json5(name, json.dumps(value))
    return zenoh.open(config)


class Outgoing:
    """What this program sends on a topic: the last number, and what others may lack."""

    def __init__(self, kind):
        self.is_state, self.last, self.kept, self.newest = kind == "state", 0, {}, {}

    def keep(self, key, value, envelope):
        if self.is_state:
            self.kept.pop(self.newest.get(key), None)
        self.last += 1
        self.newest[key], self.kept[self.last] = self.last, (value, envelope)


class Incoming:
    """What arrives from a program on a topic. `next` is 0 until that has said where this program begins."""

    def __init__(self):
        self.next, self.last, self.waiting = 0, 0, {}

    def skip(self, first, end, but=()):
        for number in range(max(first, self.next), end):
            if number not in but:
                self.waiting.setdefault(number, None)

    def ready(self):
        while self.next and self.next in self.waiting:
            arrived = self.waiting.pop(self.next)
            self.next += 1
            if arrived:
                yield arrived


class Peer:
    def __init__(self, url, name, topics, sends=(), reads=(), vote=SILENT):
        self.name, self.topics, self.reads, self.vote = name, topics, reads, vote
        self.program, self.began, self.sign, self.was_done = random.getrandbits(62), time.time_ns(), 0, False
        self.outgoing = {topic: Outgoing(topics[topic][0]) for topic in sends}
        self.incoming = defaultdict(Incoming)  # by program and topic
        self.needs = {}  # by program and topic: the first number that the program lacks of this one
        self.others = {}  # by program: its last sign of life, and when that was
        self.heard, self.due = queue.Queue(), 0.0
        self.session, self.own = join(url), f"{self.program:x}"
        keys = ["alive/*", f"ask/{self.own}", f"covered/{self.own}", f"again/{self.own}/*"]
        for key in keys + [f"topic/{topic}/**" for topic in reads]:
            self.session.declare_subscriber("saoms/2/" + key, self.heard.put)

    def send(self, topic, value):
        (_, schema, schema_number), outgoing = self.topics[topic], self.outgoing[topic]
        key, payload = value[schema["key"]] if "key" in schema else None, encode(schema, value)
        enclosed = dict(size=len(payload), to="", key=key or 0, has_key=key is not None, sent=time.time_ns(), cause=0)
        envelope = dict(program=self.program, component=self.name, schema=schema_number, number=outgoing.last + 1,
                        messages=[enclosed], cells=[])
        outgoing.keep(key, payload, encode(ENVELOPE, envelope))
        self.put(f"topic/{topic}/{self.name}", *outgoing.kept[outgoing.last])

    def receive(self, seconds):
        """What arrives within this time: topic, component and message of each. It has to be called again and again."""
        end = time.monotonic() + seconds
        while (now := time.monotonic()) < end:
            if now >= self.due:
                self.due = now + INTERVAL
                self.forget(now)
                self.say_alive()
                self.ask()
            try:
                sample = self.heard.get(timeout=max(0.0, min(end, self.due) - now))
            except queue.Empty:
                continue
            for topic, component, payload in self.take(sample):
                yield topic, component, decode(self.topics[topic][1], payload)

    def is_read(self, topic):
        return any(read == topic for _, read in self.needs)

    def is_over(self):
        """True if no other program sees work left, and one has seen that all is done."""
        votes = [alive["vote"] for alive, _ in self.others.values()]
        return OPEN not in votes and (self.was_done or DONE in votes)

    def leave(self):
        """Ends the program, once others have received its events."""
        end = time.monotonic() + 10
        list(self.receive(3 * INTERVAL))  # what it votes is heard, even if the last sign of life is lost
        while time.monotonic() < end and any(first <= self.outgoing[topic].last and not self.outgoing[topic].is_state
                                             for (_, topic), first in self.needs.items()):
            list(self.receive(INTERVAL))
        self.say_alive(leaves=True)
        self.session.close()

    def put(self, key, value, envelope=None):
        self.session.put("saoms/2/" + key, value, attachment=envelope)

    def say_alive(self, leaves=False):
        self.sign += 1
        sends = [dict(topic=topic, is_state=one.is_state, last=one.last, oldest=min([one.last + 1, *one.kept]),
                      before=0, by_cells=False, since=0, cells=[])
                 for topic, one in self.outgoing.items()]
        for one in sends:
            one["oldest"] = 1 if one["is_state"] else one["oldest"]
        received = [dict(program=program, topic=topic, next=one.next)
                    for (program, topic), one in self.incoming.items() if one.next]
        welcomes = [dict(reader=reader, topic=topic, first=first) for (reader, topic), first in self.needs.items()]
        alive = dict(program=self.program, origin=self.program, start=0, began=self.began, name=self.name,
                     number=self.sign, patience=int(PATIENCE * 1000), sends=sends,
                     reads=[dict(topic=topic) for topic in self.reads], received=received, welcomes=welcomes, vote=self.vote, leaves=leaves)
        self.put("alive/" + self.own, encode(ALIVE, alive))

    def ask(self):
        """Asks for what is missing."""
        for (program, topic), one in self.incoming.items():
            if one.next and one.next <= one.last:
                last = min([one.last + 1, *one.waiting]) - 1
                again = dict(reader=self.program, topic=topic, first=one.next, last=last)
                self.put(f"ask/{program:x}", encode(AGAIN, again))

    def forget(self, now):
        """Forgets programs that were away for long, and events that nobody lacks."""
        for program, (alive, at) in list(self.others.items()):
            if now > at + 10 * alive["patience"] / 1000:
                self.lose(program)
        for topic, one in self.outgoing.items():
            oldest = min([first for (_, read), first in self.needs.items() if read == topic], default=one.last + 1)
            for number in [] if one.is_state else [number for number in one.kept if number < oldest]:
                del one.kept[number]

    def lose(self, program):
        self.was_done |= self.others.pop(program)[0]["vote"] == DONE
        for names in (self.needs, self.incoming):
            for name in [name for name in names if name[0] == program]:
                del names[name]

    def take(self, sample):
        _, _, what, *names = str(sample.key_expr).split("/")
        payload = sample.payload.to_bytes()
        if what in ("topic", "again") and sample.attachment:
            envelope = decode(ENVELOPE, sample.attachment.to_bytes())
            topic, at = names[what == "again"], 0
            one, is_known = self.incoming[envelope["program"], topic], envelope["schema"] == self.topics[topic][2]
            for number, enclosed in enumerate(envelope["messages"], envelope["number"]):
                value, at = payload[at:at + enclosed["size"]], at + enclosed["size"]
                one.last = max(one.last, number)
                if number >= one.next:
                    one.waiting[number] = (topic, envelope["component"], value) if is_known else None
            yield from one.ready()
        elif what == "alive":
            alive = decode(ALIVE, payload)
            if alive["program"] != self.program:
                yield from self.take_alive(alive)
        elif what == "ask":
            again = decode(AGAIN, payload)
            if again["topic"] in self.outgoing:
                self.answer(again["reader"], again["topic"], again["first"], again["last"])
        elif what == "covered":
            covered = decode(COVERED, payload)
            one = self.incoming[covered["program"], covered["topic"]]
            one.skip(covered["first"], covered["last"] + 1, set(covered["numbers"]))  # they are outdated
            yield from one.ready()

    def answer(self, reader, topic, first, last):
        one = self.outgoing[topic]
        numbers = [number for number in one.kept if first <= number <= last]
        for number in numbers:
            self.put(f"again/{reader:x}/{topic}", *one.kept[number])
        if one.is_state:
            covered = dict(program=self.program, topic=topic, first=first, last=min(last, one.last), numbers=numbers)
            self.put(f"covered/{reader:x}", encode(COVERED, covered))

    def take_alive(self, alive):
        program = alive["program"]
        self.others[program] = alive, time.monotonic()
        for topic in [reads["topic"] for reads in alive["reads"] if reads["topic"] in self.outgoing]:
            one = self.outgoing[topic]
            self.needs.setdefault((program, topic), 1 if one.is_state else one.last + 1)
        for own in alive["received"]:
            if own["program"] == self.program and (program, own["topic"]) in self.needs:
                self.needs[program, own["topic"]] = max(self.needs[program, own["topic"]], own["next"])
        for welcome in [one for one in alive["welcomes"] if one["reader"] == self.program]:
            one = self.incoming[program, welcome["topic"]]
            if not one.next:
                one.next = welcome["first"]
                one.waiting = {number: it for number, it in one.waiting.items() if number >= one.next}
        for sends in alive["sends"]:
            if sends["topic"] in self.reads:
                one = self.incoming[program, sends["topic"]]
                one.last = max(one.last, sends["last"])
                one.skip(1, sends["oldest"] if one.next else 0)  # they are lost
                yield from one.ready()
        if alive["leaves"]:
            self.lose(program)
