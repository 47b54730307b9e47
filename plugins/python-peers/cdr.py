"""Messages as plain CDR, by their schemas as `saoms components --format json` prints them."""
import json
import struct

FORMATS = {"bool": "?", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
           "int64": "q", "uint64": "Q", "float32": "f", "float64": "d", "time": "Q"}


def message(**fields):
    """The schema of a message with these fields."""
    return {"fields": [{"name": name, "type": kind} for name, kind in fields.items()]}


def encode(schema, value):
    out = bytearray()
    write(out, schema, value)
    return b"\0\1\0\0" + (bytes(out) or b"\0")


def decode(schema, data):
    return read(bytes(data)[4:], 0, schema)[0]


def schema_hash(schema):
    """What an envelope says of the schema of its message: both ends have to have the same one."""
    state = 0
    for byte in json.dumps(schema, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode():
        product = (state ^ 0xA0761D6478BD642F) * (byte ^ 0xE7037ED1A0B428DB)
        state = (product ^ product >> 64) & (1 << 64) - 1
    return state


def write(out, kind, value):
    if kind == "string":
        write_all(out, "uint8", value.encode() + b"\0")
    elif isinstance(kind, str):
        form = struct.Struct("<" + FORMATS[kind])
        out += bytes(-len(out) % form.size) + form.pack(value)
    elif "fields" in kind:
        for field in kind["fields"]:
            write(out, field["type"], value[field["name"]])
    elif "enumeration" in kind:
        write(out, kind["enumeration"], kind["values"][value])
    elif "optional" in kind:
        write_all(out, kind["optional"], [] if value is None else [value])
    elif "array" in kind:
        for element in value:
            write(out, kind["array"], element)
    elif "bounded" in kind:
        write(out, kind["bounded"], value)
    else:
        write_all(out, kind["sequence"], value)


def write_all(out, kind, values):
    write(out, "uint32", len(values))
    for value in values:
        write(out, kind, value)


def read(data, at, kind):
    """The value there, and the place behind it."""
    if kind == "string":
        length, at = read(data, at, "uint32")
        return data[at:at + length - 1].decode(), at + length
    if isinstance(kind, str):
        form = struct.Struct("<" + FORMATS[kind])
        at += -at % form.size
        return form.unpack_from(data, at)[0], at + form.size
    if "fields" in kind:
        value = {}
        for field in kind["fields"]:
            value[field["name"]], at = read(data, at, field["type"])
        return value, at
    if "enumeration" in kind:
        number, at = read(data, at, kind["enumeration"])
        return next((name for name, one in kind["values"].items() if one == number), number), at
    if "bounded" in kind:
        return read(data, at, kind["bounded"])
    inner, values = kind.get("sequence") or kind.get("optional") or kind.get("array"), []
    length, at = (kind["length"], at) if "array" in kind else read(data, at, "uint32")
    for _ in range(length):
        value, at = read(data, at, inner)
        values.append(value)
    return ((values or [None])[0] if "optional" in kind else values), at
