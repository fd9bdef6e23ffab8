"""What is refused."""


class ParameterError(ValueError):
    """A value was refused: its field, the value, and the limit, what it must be."""

    def __init__(self, field: str, value: float | str, limit: str, place: str = "") -> None:
        message = f"{field} = {str(value).removesuffix('.0')}: {limit}"
        super().__init__(f"{place}: {message}" if place else message)
        self.field = field
        self.value = value
        self.limit = limit
