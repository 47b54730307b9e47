"""Messages as CDR, by the schema that the program knows and the classes that the component has."""
import struct
import typing

FORMATS = {"bool": "?", "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I",
           "int64": "q", "uint64": "Q", "float32": "f", "float64": "d", "time": "Q"}
HEADER = b"\0\1\0\0"


def codec(schema, cls):
    """The functions that make bytes of a message, and a message of bytes."""
    names = [field["name"] for field in schema["fields"]]
    forms = [FORMATS.get(field["type"]) if isinstance(field["type"], str) else None for field in schema["fields"]]
    if names and all(forms):
        return fixed(names, forms, cls)
    write, read = value(schema, cls)

    def encode(one):
        out = bytearray()
        write(out, one)
        return HEADER + (bytes(out) or b"\0")

    return encode, lambda data: read(data[4:], 0)[0]


def fixed(names, forms, cls):
    """The same where each field has its place: one call of `struct` for all."""
    layout, at = "<4s", 0
    for form in forms:
        size = struct.calcsize("<" + form)
        padding = -at % size
        layout += "x" * padding + form
        at += padding + size
    whole = struct.Struct(layout)
    arguments = ", ".join(f"one.{name}" for name in names)
    made = {"pack": whole.pack, "unpack": whole.unpack_from, "cls": cls, "HEADER": HEADER}
    exec(f"def encode(one):\n    return pack(HEADER, {arguments})\n"
         "def decode(data):\n    return cls(*unpack(data)[1:])\n", made)
    return made["encode"], made["decode"]


def value(kind, hint):
    """The functions that write a value of this type, and read one."""
    if kind == "string":
        return write_string, read_string
    if isinstance(kind, str):
        return scalar(FORMATS[kind])
    if "fields" in kind:
        return nested(kind, hint)
    if "enumeration" in kind:
        write, read = scalar(FORMATS[kind["enumeration"]])

        def constant(data, at):
            number, at = read(data, at)
            try:
                return hint(number), at
            except ValueError:
                return number, at
        return write, constant
    if "bounded" in kind:
        return value(kind["bounded"], hint)
    if "optional" in kind:
        inner = [one for one in typing.get_args(hint) if one is not type(None)]
        write_all, read_all = sequence(kind["optional"], inner[0] if inner else None, None)
        return (lambda out, one: write_all(out, () if one is None else (one,)),
                lambda data, at: first(read_all(data, at)))
    inner = (typing.get_args(hint) or (None,))[0]
    return sequence(kind.get("sequence") or kind["array"], inner, kind.get("length"))


def first(found):
    values, at = found
    return (values[0] if values else None), at


def scalar(form):
    packed = struct.Struct("<" + form)
    size = packed.size

    def write(out, one):
        out += bytes(-len(out) % size) + packed.pack(one)

    def read(data, at):
        at += -at % size
        return packed.unpack_from(data, at)[0], at + size
    return write, read


write_length, read_length = scalar("I")


def write_string(out, one):
    data = one.encode()
    write_length(out, len(data) + 1)
    out += data + b"\0"


def read_string(data, at):
    length, at = read_length(data, at)
    return data[at:at + length - 1].decode(), at + length


def sequence(kind, hint, length):
    write, read = value(kind, hint)

    def write_all(out, values):
        if length is None:
            write_length(out, len(values))
        elif len(values) != length:
            raise ValueError(f"found an array of {len(values)}, expected {length}")
        for one in values:
            write(out, one)

    def read_all(data, at):
        count, at = read_length(data, at) if length is None else (length, at)
        found = []
        for _ in range(count):
            one, at = read(data, at)
            found.append(one)
        return found, at
    return write_all, read_all


def nested(schema, cls):
    hints = typing.get_type_hints(cls)
    parts = [(field["name"], *value(field["type"], hints[field["name"]])) for field in schema["fields"]]

    def write(out, one):
        for name, write_field, _ in parts:
            write_field(out, getattr(one, name))

    def read(data, at):
        values = []
        for _, _, read_field in parts:
            one, at = read_field(data, at)
            values.append(one)
        return cls(*values), at
    return write, read


def arguments(operation, method):
    """The functions that write and read the arguments of an operation, and its reply."""
    hints = typing.get_type_hints(method)
    parts = [value(one["type"], hints[one["name"]]) for one in operation["arguments"]]
    reply = operation["reply"]
    answer = None if reply is None else value(reply, hints["return"])

    def encode(values):
        out = bytearray()
        for (write, _), one in zip(parts, values):
            write(out, one)
        return HEADER + (bytes(out) or b"\0")

    def decode(data):
        data, at, values = data[4:], 0, []
        for _, read in parts:
            one, at = read(data, at)
            values.append(one)
        return values

    def encode_reply(one):
        out = bytearray()
        if answer is not None:
            answer[0](out, one)
        return HEADER + (bytes(out) or b"\0")

    def decode_reply(data):
        return None if answer is None else answer[1](data[4:], 0)[0]
    return encode, decode, encode_reply, decode_reply
