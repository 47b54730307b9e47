"""Components of SAOMS fleets in Python.

A component is a class whose annotations say what it has: properties, topics, services and references. The program reads
them without running the file.

    import saoms
    from saoms import uint32

    @saoms.message
    class Count:
        number: uint32

    class Counter(saoms.Component):
        step: uint32 = saoms.property(1, min=1, max=100)
        count: saoms.Publisher[Count] = saoms.state("COUNT")

        def initialize(self) -> None:
            self.number = 0

        def execute(self) -> None:
            self.number += self.step
            self.count.send(Count(self.number))
"""
import builtins
import dataclasses
import enum
import random as _random
from typing import TYPE_CHECKING, Annotated, Any, Callable, Dict, Generic, Iterator, List, Optional, Type, TypeVar, overload

if TYPE_CHECKING:
    from typing_extensions import dataclass_transform
else:
    def dataclass_transform(**_):
        return lambda decorator: decorator

__all__ = [
    "Busy", "Component", "Context", "Enumeration", "Failure", "Interface", "Journal", "Publisher", "Received", "Service",
    "Subscription", "Time", "Duration", "enumeration", "event", "message", "property", "state", "int8", "int16", "int32",
    "int64", "uint8", "uint16", "uint32", "uint64", "float32", "float64",
]

int8 = Annotated[int, "int8"]
int16 = Annotated[int, "int16"]
int32 = Annotated[int, "int32"]
int64 = Annotated[int, "int64"]
uint8 = Annotated[int, "uint8"]
uint16 = Annotated[int, "uint16"]
uint32 = Annotated[int, "uint32"]
uint64 = Annotated[int, "uint64"]
float32 = Annotated[float, "float32"]
float64 = Annotated[float, "float64"]
# A time of the run, in nanoseconds since its start.
Time = Annotated[int, "time"]
# A property with a unit of time in the composite; its value is in seconds.
Duration = Annotated[float, "duration"]

T = TypeVar("T")
M = TypeVar("M")


class Failure(Exception):
    """A failure of a component, without a traceback: `restart` of the composite decides."""


class Busy(Exception):
    """The provider of a service is in the middle of something, or not running. An execution that ends with it is skipped."""


@overload
@dataclass_transform()
def message(cls: Type[T]) -> Type[T]: ...


@overload
@dataclass_transform()
def message(*, name: str = ..., key: str = ..., place: str = ..., speaker: str = ...) -> Callable[[Type[T]], Type[T]]: ...


def message(cls: Any = None, *, name: Optional[str] = None, key: Optional[str] = None, place: Optional[str] = None,
            speaker: Optional[str] = None) -> Any:
    """Makes a message of a class: its annotations are the fields, in their order. `key` is the field by which a state
    topic keeps one message each, `place` the one that is its block, `speaker` the one that says who sends it."""
    return dataclasses.dataclass if cls is None else dataclasses.dataclass(cls)


class Enumeration(enum.IntEnum):
    """An integer of a message with named constants."""


def enumeration(of: str) -> Callable[[Type[T]], Type[T]]:
    """Says which integer an `Enumeration` is in messages; without it, `uint8`."""
    return lambda cls: cls


class Interface:
    """What a service offers: methods with annotations. The name is that of module and class, or the one in
    `class Numbers(saoms.Interface, name="counter.Numbers")`."""

    def __init_subclass__(cls, name: Optional[str] = None) -> None:
        super().__init_subclass__()


class Service(Generic[T]):
    """Declares that a component serves an interface: `numbers: saoms.Service[Numbers]`. Its methods are those of the
    component with the same names."""


class _Declared:
    """What stands at an annotation until the component is made."""


def property(default: Any = None, *, name: Optional[str] = None, min: Any = None, max: Any = None,
             doc: Optional[str] = None, unit: Optional[str] = None, live: bool = False, non_empty: bool = False,
             allowed: Optional[List[str]] = None, speaker: bool = False) -> Any:
    """A property, with more than its default."""
    return _Declared()


def state(topic: str, *, optional: bool = False) -> Any:
    """A topic that keeps the newest message of each publisher or key. `optional`: it needs no reader."""
    return _Declared()


def event(topic: str, *, optional: bool = False) -> Any:
    """A topic that loses no message. `optional`: it needs no reader."""
    return _Declared()


class Publisher(Generic[M]):
    """A topic that the component publishes on."""

    def __init__(self, host: Any, index: int, encode: Callable[[M], bytes]) -> None:
        self._host, self._index, self._encode = host, index, encode

    def send(self, message: M) -> None:
        """Sends a message; it leaves at the end of the execution."""
        self._host.send(self._index, self._encode(message))


@dataclasses.dataclass
class Received(Generic[M]):
    """A message with what is known of it: when it was sent, by whom (its index in the fleet), and its cause."""
    message: M
    sent: int
    sender: int
    cause: int


class Subscription(Generic[M]):
    """A topic that the component subscribes to: the messages that arrived since the last execution, the oldest first."""

    def __init__(self, host: Any, index: int, decode: Callable[[bytes], M]) -> None:
        self._host, self._index, self._decode = host, index, decode

    def __iter__(self) -> Iterator[M]:
        return (self._decode(one[0]) for one in self._host.inbox(self._index))

    def newest(self) -> Optional[M]:
        """The last one that arrived since the last execution."""
        arrived = self._host.inbox(self._index)
        return self._decode(arrived[-1][0]) if arrived else None

    def received(self) -> List[Received[M]]:
        """The same messages with what is known of them."""
        return [Received(self._decode(data), sent, sender, cause)
                for data, sent, sender, cause in self._host.inbox(self._index)]


class Journal:
    """Records why something happens. A text has `{name}` where a value goes: a truth value, a number, a text, or a pair
    of small whole numbers."""

    def __init__(self, host: Any) -> None:
        self._host = host

    def symptom(self, id: str, text: str, **values: Any) -> None:
        self._record(0, id, text, values)

    def decision(self, id: str, text: str, **values: Any) -> None:
        self._record(1, id, text, values)

    def effect(self, id: str, text: str, **values: Any) -> None:
        self._record(2, id, text, values)

    def because(self, cause: int) -> None:
        """What follows was caused by this: the `cause` of a message."""
        self._host.because(cause)

    def _record(self, phase: int, id: str, text: str, values: Dict[str, Any]) -> None:
        self._host.journal(phase, id, text, "".join(name + "," for name in values), tuple(values.values()))


class Context:
    """What the program lends a component in each call. Use its time and its random numbers alone, so that a run in
    virtual time can be repeated."""

    def __init__(self, host: Any) -> None:
        self._host = host
        self.journal = Journal(host)
        self._chance: Optional[_random.Random] = None

    @builtins.property
    def name(self) -> str:
        """The path of the component."""
        return str(self._host.name())

    @builtins.property
    def now(self) -> float:
        """Seconds since the start of the run. In virtual time it stands still during an execution."""
        return float(self._host.now() / 1e9)

    @builtins.property
    def due(self) -> float:
        """When the present execution was due."""
        return float(self._host.due() / 1e9)

    @builtins.property
    def period(self) -> float:
        """The period in seconds; 0 for a passive component."""
        return float(self._host.period() / 1e9)

    @builtins.property
    def execution(self) -> int:
        """The number of the present execution, from 0."""
        return int(self._host.execution())

    @builtins.property
    def sender(self) -> int:
        """The index of the component in the fleet, as in what it sends."""
        return int(self._host.sender())

    @builtins.property
    def cancelled(self) -> bool:
        """True if a long execution should end early."""
        return bool(self._host.cancelled())

    @builtins.property
    def random(self) -> _random.Random:
        """Random numbers of the component, from the seed of the run."""
        if self._chance is None:
            self._chance = _random.Random(self._host.random())
        return self._chance

    def error(self, line: object) -> None:
        self._host.log(0, str(line))

    def warn(self, line: object) -> None:
        self._host.log(1, str(line))

    def info(self, line: object) -> None:
        self._host.log(2, str(line))

    def debug(self, line: object) -> None:
        if self._host.listens(3):
            self._host.log(3, str(line))

    def report(self, path: str, value: Any) -> None:
        """Sets a value of the report; dots lead into nested objects."""
        self._host.report(path, value)

    def count(self, path: str, more: int = 1) -> None:
        """Adds to a number of the report."""
        self._host.count(path, more)

    def work_left(self) -> None:
        """The run does not end while a component has work left."""
        self._host.vote(0)

    def work_done(self) -> None:
        """The run ends when all that said so have done their work."""
        self._host.vote(1)

    def raise_event(self, event: str) -> None:
        """Lets an event happen that components of the same site take: `fire at=(3,4)`."""
        self._host.raise_event(event)

    def alert(self, kind: str, subject: object, line: object) -> None:
        """Says that a person is needed."""
        self._host.alert(kind, str(subject), str(line))

    def alert_over(self, kind: str, subject: object) -> None:
        """The alert is over."""
        self._host.alert(kind, str(subject), None)


class Component:
    """A component. With a method `execute` it is periodic, without one it only serves calls. A method `status` may
    return a dictionary of what operators want to know."""

    context: Context

    def initialize(self) -> None:
        """Called once, when the component is scheduled. What it has from its annotations is there."""

    def shutdown(self) -> None:
        """Called once, when the component is unscheduled or the run ends."""

    def update(self) -> None:
        """Live properties have new values. An exception refuses them."""
