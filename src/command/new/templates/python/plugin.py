"""A component that counts, and publishes the count on its own topic."""
import saoms
from saoms import uint64


@saoms.message
class Count:
    """A count."""

    number: uint64


class MyPlugin(saoms.Component):
    """Counts in steps."""

    step: uint64 = saoms.property(1, min=1, max=1000)
    """How far it counts in a period."""

    count: saoms.Publisher[Count] = saoms.event("COUNT", optional=True)

    def initialize(self) -> None:
        self.number = 0

    def execute(self) -> None:
        self.number += self.step
        self.count.send(Count(self.number))
        self.context.report("count.number", self.number)
