"""XML of bounded size and depth, without DTDs, entities or anything external."""

import re
from typing import Any
from xml.etree.ElementTree import Element, TreeBuilder

from defusedxml import DefusedXmlException  # type: ignore[import-untyped]
from defusedxml.ElementTree import (  # type: ignore[import-untyped]
    DefusedXMLParser,
    ParseError,
)

from auricle.errors import FormatError
from auricle.surface.formats.header import damaged

MOST_BYTES = 64 * 1024**2
_DEEPEST = 64
_DECLARED = re.compile(rb"^\s*<\?xml[^>]*encoding")
_BYTE_ORDER_MARKS = (b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff")


class _BoundedBuilder(TreeBuilder):
    def __init__(self, *, comments: bool) -> None:
        super().__init__(insert_comments=comments)
        self._depth = 0

    def start(self, tag: str, attrs: dict[Any, Any]) -> Element:
        self._depth += 1
        if self._depth > _DEEPEST:
            raise FormatError(f"holds XML nested more than {_DEEPEST} deep: the file is damaged")
        return super().start(tag, attrs)

    def end(self, tag: str) -> Element:
        self._depth -= 1
        return super().end(tag)


def parse_xml(content: bytes, *, where: str, comments: bool = False) -> Element:
    """Root element of a document.

    Text in neither UTF-8 nor a declared encoding is taken for Windows-1252, as mapping systems
    write it.

    Parameters
    ----------
    content
        The whole document.
    where
        What is read, for the message.
    comments
        Keep comments, as elements of their own.

    Raises
    ------
    FormatError
        If it is not well-formed, too large, nested too deep, or has a DTD or entities.
    """
    if len(content) > MOST_BYTES:
        raise FormatError(f"holds {len(content):,} bytes of XML in {where}: export less")
    parser = DefusedXMLParser(target=_BoundedBuilder(comments=comments), forbid_dtd=True)
    try:
        parser.feed(_in_utf8(content))
        root: Element = parser.close()
    except DefusedXmlException as fault:
        raise FormatError(f"holds a DTD or entities in {where}: do not use it") from fault
    except (ParseError, LookupError, ValueError) as fault:
        raise damaged(f"holds XML that is not well-formed in {where}") from fault
    return root


def _in_utf8(content: bytes) -> bytes:
    if content.startswith(_BYTE_ORDER_MARKS) or _DECLARED.match(content):
        return content
    try:
        content.decode()
    except UnicodeDecodeError:
        return content.decode("cp1252", "replace").encode()
    return content
