"""Says of messages which schema and which bytes rosbags gives them: JSON in, JSON out."""
import json
import sys

import numpy
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

asked = json.load(sys.stdin)
store = get_typestore(Stores.ROS2_HUMBLE)
for name, definition in asked["definitions"].items():
    store.register(get_types_from_msg(definition, name))


def schema(name):
    constants, fields = store.fielddefs[name]
    shape = {"name": name, "fields": [{"name": field, "type": kind(of)} for field, of in fields]}
    if constants:
        shape["constants"] = [{"name": one, "type": of, "value": value} for one, of, value in constants]
    return shape


def kind(of):
    node, what = of
    if node.name == "BASE":
        of, most = what
        return {"bounded": of, "most": most} if most else of
    if node.name == "NAME":
        return schema(what)
    inner, count = what
    if node.name == "ARRAY":
        return {"array": kind(inner), "length": count}
    sequence = {"sequence": kind(inner)}
    return {"bounded": sequence, "most": count} if count else sequence


def value(of, json_value):
    node, what = of
    if node.name == "BASE":
        return float(json_value) if what[0].startswith("float") else json_value
    if node.name == "NAME":
        fields = store.fielddefs[what][1]
        return store.types[what](**{name: value(of, json_value[name]) for name, of in fields})
    elements = [value(what[0], one) for one in json_value]
    inner, base = what[0]
    if inner.name == "BASE" and base[0] != "string":
        return numpy.array(elements, dtype=base[0])
    return elements


def written(one):
    message = value((Nodetype.NAME, one["type"]), one["value"])
    return store.serialize_cdr(message, one["type"]).hex()


names = sorted({one["type"] for one in asked["messages"]})
json.dump({"schemas": {name: schema(name) for name in names}, "bytes": list(map(written, asked["messages"]))}, sys.stdout)
