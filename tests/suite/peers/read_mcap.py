"""Compares what mcap-ros2-support reads in a recording with the lines of `saoms record cat` on standard input."""
import json
import re
import sys

from mcap_ros2.reader import read_ros2_messages

# What the constants of enumerations are called, by topic and field: one name for each number.
names = {}


def snake(name):
    return re.sub("([a-z])([A-Z])", r"\1_\2", name).lower()


def same(ours, theirs, place):
    if ours is None:
        return len(theirs) == 0
    if isinstance(ours, list):
        return len(ours) == len(theirs) and all(same(*pair, place) for pair in zip(ours, theirs))
    if not isinstance(theirs, str) and hasattr(theirs, "__len__"):
        # It is optional, and there.
        (theirs,) = theirs
    if isinstance(ours, dict):
        return all(same(ours[name], getattr(theirs, snake(name)), f"{place}.{name}") for name in ours)
    if isinstance(ours, str) and isinstance(theirs, int):
        known = names.setdefault(place, {}).setdefault(theirs, ours)
        return known == ours and len(set(names[place].values())) == len(names[place])
    return ours == theirs


recorded = {}
for message in read_ros2_messages(sys.argv[1]):
    recorded.setdefault(message.channel.topic, []).append(message)
senders = recorded.pop("/saoms/senders")
ours = {}
for line in sys.stdin:
    line = json.loads(line)
    ours.setdefault(line["topic"], []).append(line)
assert ours.keys() == recorded.keys(), (ours.keys(), recorded.keys())
for topic, lines in ours.items():
    assert len(lines) == len(recorded[topic]), topic
    # They are read in the order of their times.
    lines.sort(key=lambda line: line["time_s"])
    for line, message in zip(lines, recorded[topic]):
        assert message.log_time_ns == round(line["time_s"] * 1e9), line
        assert same(line["message"], message.ros_msg, topic), (line, message.ros_msg)
told = sum(len(message.ros_msg.senders) for message in senders)
assert told == sum(len(lines) for topic, lines in ours.items() if not topic.startswith("/"))

# What Foxglove draws agrees with what the robots said until then.
newest = {}
said = [message for topic in ["POSTOPIC", "RLMSTOPIC"] for message in recorded[topic]]
said.sort(key=lambda message: message.log_time_ns)
for frames in recorded["/tf"]:
    while said and said[0].log_time_ns <= frames.log_time_ns:
        message = said.pop(0)
        newest[message.channel.topic, message.ros_msg.robot] = message.ros_msg
    shown = {}
    for one in frames.ros_msg.transforms:
        stamp = one.header.stamp
        assert (one.header.frame_id, stamp.sec * 10**9 + stamp.nanosec) == ("map", frames.log_time_ns), one
        shown[one.child_frame_id] = (one.transform.translation.x, one.transform.translation.y)
    for (topic, robot), message in newest.items():
        state = newest.get(("RLMSTOPIC", robot))
        if topic == "POSTOPIC" and not (state and state.in_charge):
            assert shown[f"robot{robot}"] == (message.block.x + 0.5, -message.block.y - 0.5), (message, shown)
robots = {robot for _, robot in newest}
scene = {}
for update in recorded["/scene"]:
    for entity in update.ros_msg.entities:
        scene[entity.id] = entity
    for deletion in update.ros_msg.deletions:
        del scene[deletion.id]
assert {f"robot{robot}" for robot in robots} <= scene.keys(), scene.keys()
for robot in robots:
    [text] = scene[f"robot{robot}"].texts
    number, battery = text.text.split("\n")
    assert (int(number), battery[-2:]) == (robot, " %"), text
assert any(entity.id.startswith("luggage") for update in recorded["/scene"] for entity in update.ros_msg.entities)
[grid] = recorded["/map"]
assert len(grid.ros_msg.data) == grid.ros_msg.info.width * grid.ros_msg.info.height > 0
assert recorded["/floor"][-1].ros_msg.entities
print(sum(map(len, ours.values())))
