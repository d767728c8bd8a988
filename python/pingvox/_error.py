"""The exception of this package."""


class Error(Exception):
    """What the library could not do; its text names the file, the place in it and the reason.

    code is 'bad_option' (invalid arguments), 'io' (the operating system), 'corrupt' (data that violate their format),
    'unsupported', 'limit' (a limit of memory; the map is as it was) or 'no_memory'.
    """

    code: str

    def __init__(self, message: str, code: str = "unsupported") -> None:
        super().__init__(message, code)
        self.code = code

    def __str__(self) -> str:
        return str(self.args[0])
