"""A component with a period, a property that is checked, a message and a topic of its own, and a service."""
import saoms
from saoms import uint32


@saoms.message
class Count:
    """A count."""
    number: uint32


class Numbers(saoms.Interface):
    """The count for callers."""

    def number(self) -> uint32:
        raise NotImplementedError


class Counter(saoms.Component):
    """A component that counts in steps."""

    step: uint32 = saoms.property(1, min=1, max=100)
    """Number that is added in each period."""
    count: saoms.Publisher[Count] = saoms.state("COUNT")
    numbers: saoms.Service[Numbers]

    def initialize(self) -> None:
        self.counted = 0

    def execute(self) -> None:
        self.counted += self.step
        self.count.send(Count(self.counted))

    def number(self) -> uint32:
        return self.counted


class Reader(saoms.Component):
    """A component that reads what a counter says, and asks it for its number."""

    counts: saoms.Subscription[Count] = saoms.state("COUNT")
    counter: Numbers

    def execute(self) -> None:
        for count in self.counts:
            asked = self.counter.number()
            self.context.journal.symptom("count_seen", "sees the count {count}, and is told {asked}", count=count.number,
                                         asked=asked)
            self.context.report("reader.count", count.number)
