"""Files as part of the page."""

import base64


def data_uri(content: bytes, kind: str) -> str:
    """`content` as an address that holds it; `kind` is its media type."""
    return f"data:{kind};base64,{base64.b64encode(content).decode()}"
