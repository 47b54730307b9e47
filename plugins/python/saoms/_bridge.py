"""What the program calls: components of classes, with all that their annotations declare."""
import importlib
import json
import linecache
import sys
import traceback
import typing

import _saoms
import saoms
from saoms import _codec, _declare

NONE = None
OK, FAILED, NOT_WIRED, BUSY, NOT_RUNNING = 0, 1, 3, 4, 5
UNITS = (("ns", 1e-9), ("us", 1e-6), ("µs", 1e-6), ("ms", 1e-3), ("min", 60.0), ("s", 1.0), ("h", 3600.0), ("d", 86400.0))


def declare(text):
    return _declare.declare(text)


def create(text, values):
    """A component of the class that a request names."""
    return Runner(json.loads(text), json.loads(values))


class Runner:
    """A component, as the program calls it. Each call gives None, or the status and the text of a failure."""

    def __init__(self, request, values):
        self.request, self.values, self.component = request, values, None

    def initialize(self):
        try:
            module, reader, _ = _declare.read(self.request)
            if reader.faults:
                raise saoms.Failure(reader.faults[0].finding()["message"])
            cls = getattr(imported(self.request["module"], module.file, self.request["folders"]), self.request["class"])
            self.component = component = cls.__new__(cls)
            component.context = saoms.Context(_saoms)
            self.fields = {field: one[1] for field, one in reader.bindings.items() if one[0] == "property"}
            self.set(self.values)
            self.bind(component, cls, reader)
            component.__init__()
            component.initialize()
            self.executing = getattr(component, "execute", None)
            self.status_of = getattr(component, "status", None)
            self.told = None
        except BaseException as error:
            return failed(error)

    def bind(self, component, cls, reader):
        hints = typing.get_type_hints(cls)
        self.services = {}
        references = {one["name"]: one for one in reader.result["references"]}
        for field, binding in reader.bindings.items():
            hint = hints[field]
            if binding == "reference":
                setattr(component, field, reference(references[field], hint))
            elif binding == "service":
                operations = next(one for one in reader.result["services"] if one["name"] == field)
                self.services[field] = [
                    (getattr(component, one["name"]), *_codec.arguments(one, getattr(cls, one["name"])))
                    for one in operations["interface"]["operations"]]
            elif binding[0] in ("publishes", "subscribes"):
                topic = binding[1]
                encode, decode = _codec.codec(topic["schema"], typing.get_args(hint)[0])
                view = (topic["topic"], topic["message"], json.dumps(topic["schema"], separators=(",", ":")),
                        ["state", "event"].index(topic["kind"]))
                if binding[0] == "publishes":
                    setattr(component, field, saoms.Publisher(_saoms, _saoms.publish(*view), encode))
                else:
                    setattr(component, field, saoms.Subscription(_saoms, _saoms.subscribe(*view), decode))

    def set(self, values):
        for field, one in self.fields.items():
            text = values.get(one["name"], one.get("default"))
            if one.get("many"):
                given = [] if text is None else text if isinstance(text, list) else [text]
                setattr(self.component, field, [converted(one, each) for each in given])
            elif text is not None:
                setattr(self.component, field, converted(one, text))

    def execute(self):
        try:
            self.executing()
            if self.status_of is not None:
                return self.tell()
        except BaseException as error:
            return failed(error)

    def tell(self):
        """The status, five times a second at most."""
        now = _saoms.now()
        if self.told is None or now - self.told >= 200_000_000:
            self.told = now
            _saoms.status(json.dumps(self.status_of()))

    def react(self):
        try:
            self.component.react()
        except BaseException as error:
            return failed(error)

    def shutdown(self):
        try:
            if self.component is not None:
                self.component.shutdown()
        except BaseException as error:
            return failed(error)

    def update(self, values):
        before = dict(self.component.__dict__)
        try:
            self.set(json.loads(values))
            self.component.update()
        except BaseException as error:
            self.component.__dict__.update(before)
            return failed(error)

    def serve(self, service, operation, data):
        try:
            method, _, decode, encode_reply, _ = self.services[service][operation]
            return encode_reply(method(*decode(data)))
        except BaseException as error:
            return failed(error)


def converted(one, text):
    kind = one["type"]
    if kind == "boolean":
        return text == "true"
    if kind == "integer":
        return int(text)
    if kind == "float":
        return float(text)
    if kind == "duration":
        number, factor = next((text[:-len(unit)], factor) for unit, factor in UNITS if text.endswith(unit))
        return float(number) * factor
    return text


def imported(name, file, folders):
    """The module of this name, which has to be the one that was read."""
    for folder in reversed(folders):
        if folder not in sys.path:
            sys.path.insert(0, folder)
    module = importlib.import_module(name)
    if getattr(module, "__file__", None) != file:
        raise saoms.Failure(f"the module `{name}` is `{getattr(module, '__file__', name)}` already, and not `{file}`: "
                            "rename one of them")
    return module


def reference(declared, hint):
    """What calls through a reference: one target, a list of them, or None where an optional one leads nowhere."""
    interface = declared["interface"]
    index = _saoms.reference(declared["name"], interface["name"])
    inner = [one for one in typing.get_args(hint) if one is not type(None)]
    cls = inner[0] if inner else hint
    methods = {}
    for number, operation in enumerate(interface["operations"]):
        methods[operation["name"]] = call(number, operation, getattr(cls, operation["name"]))
    proxy = type(cls.__name__, (), methods)

    def target(place):
        one = proxy()
        one.index = index | place << 16
        return one
    if declared.get("many"):
        return [target(place) for place in range(_saoms.targets(index))]
    if declared.get("optional") and not _saoms.is_wired(index):
        return None
    return target(0)


def call(number, operation, method):
    encode, _, _, decode_reply = _codec.arguments(operation, method)
    names = [one["name"] for one in operation["arguments"]]

    def called(self, *values, **named):
        values += tuple(named[name] for name in names[len(values):])
        status, reply, text = _saoms.call(self.index, number, encode(values))
        if status == OK:
            return decode_reply(reply)
        if status in (BUSY, NOT_RUNNING):
            raise saoms.Busy(text)
        raise saoms.Failure(text.replace("\0", ": ") or "the reference is not wired")
    return called


def failed(error):
    """Status and text of a failure: one line, with the traceback before it in the log."""
    if isinstance(error, saoms.Busy):
        return BUSY, str(error)
    if isinstance(error, saoms.Failure):
        return FAILED, str(error)
    linecache.checkcache()
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    text = " ".join(text.split())
    if isinstance(error, SyntaxError):
        return FAILED, text
    own = [one for one in traceback.extract_tb(error.__traceback__) if not one.filename.startswith("<")]
    for line in "".join(traceback.format_list(own)).splitlines():
        _saoms.log(0, line)
    if own:
        text += f" ({own[-1].filename}:{own[-1].lineno}, in {own[-1].name})"
    return FAILED, text
