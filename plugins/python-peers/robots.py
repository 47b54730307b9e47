"""A robot of a fleet: what others hear of it, the luggage that masters assign to it, and how it enters a block."""
from peer import Peer, topics

FIRST = {"rank": 2**64 - 1, "robot": 0}  # the priority of a robot that never makes way


class Robot(Peer):
    def __init__(self, url, schemas, number, period=0.1):
        super().__init__(url, f"PythonRobot{number}", topics(schemas), sends=["RLMSTOPIC", "POSTOPIC", "ELMSTOPIC"],
                         reads=["JOBTOPIC", "POSTOPIC"])
        self.number, self.period = number, period
        self.charger = self.at = self.wanted = {"x": 0, "y": number}
        self.job, self.carries, self.positions = None, False, {}
        self.say_position(self.at)
        self.say_state()

    def hear(self):
        """Hears others for a period, and takes luggage that it is assigned, or gives it back."""
        for topic, component, said in self.receive(self.period):
            if topic == "POSTOPIC":
                self.positions[said["robot"]] = said
            elif said["robot"] == self.number and said["withdrawn"]:
                if self.job and not self.carries and self.job["luggage"] == said["luggage"]:
                    self.job = None
                    self.respond(said, "RELEASE")
            elif said["robot"] == self.number and self.job is None:
                self.job = said
                self.respond(said, "TAKEN")

    def want(self, block):
        """Says which block it enters next."""
        self.wanted = block
        self.say_position(self.at)

    def enter(self):
        """Enters the block that it wants, unless another one is there or wants it. True if it has."""
        if self.wanted == self.at or any(self.wanted in (one["block"], one["next"], one["wanted"])
                                         for one in self.positions.values()):
            return False
        self.say_position(self.wanted)
        self.at = self.wanted
        self.say_state()
        return True

    def deliver(self):
        """Has brought its luggage."""
        self.respond(self.job, "DELIVERED")
        self.job, self.carries = None, False

    def end(self):
        self.say_state(active=False)
        self.leave()

    def say_state(self, active=True):
        self.send("RLMSTOPIC", {"robot": self.number, "active": active, "battery": 100.0, "in_charge": False,
                                "asleep": False, "charger": self.charger, "period": int(self.period * 1e6),
                                "block": self.at, "policy": "SAFE", "began": None})

    def say_position(self, following):
        self.send("POSTOPIC", {"robot": self.number, "block": self.at, "next": following, "wanted": self.wanted,
                               "priority": FIRST})

    def respond(self, order, stage):
        print(f"luggage {order['luggage']} {stage} at ({self.at['x']},{self.at['y']})", flush=True)
        self.send("ELMSTOPIC", {"robot": self.number, "luggage": order["luggage"], "stage": stage,
                                "from": order["from"], "to": order["to"], "block": self.at})
