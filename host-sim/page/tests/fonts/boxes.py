"""Makes boxes.ttf, the only font of the system in the tests: every character is a box, wider than the letters of any font.

    python3 boxes.py     # fonttools 4.68.0
"""

from pathlib import Path

from fontTools.fontBuilder import FontBuilder
from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.ttLib import newTable
from fontTools.ttLib.tables._c_m_a_p import CmapSubtable

EM, WIDTH, ASCENT, DESCENT = 1000, 850, 1100, 350


def box(left, bottom, right, top):
    pen = TTGlyphPen(None)
    pen.moveTo((left, bottom))
    for corner in [(left, top), (right, top), (right, bottom)]:
        pen.lineTo(corner)
    pen.closePath()
    return pen.glyph()


def coverage(form, encoding, characters):
    table = CmapSubtable.newSubtable(form)
    table.platformID, table.platEncID, table.language = 0, encoding, 0
    table.cmap = characters
    if form == 13:
        table.format, table.reserved, table.length, table.nGroups = 13, 0, 0, 0
    return table


builder = FontBuilder(EM, isTTF=True)
builder.updateHead(created=0, modified=0)
builder.setupGlyphOrder([".notdef", "space", "box"])
builder.setupGlyf({".notdef": box(50, 0, 800, 750), "space": TTGlyphPen(None).glyph(), "box": box(50, 0, 800, 750)})
builder.setupHorizontalMetrics({name: (WIDTH, 50) for name in [".notdef", "space", "box"]})
builder.setupHorizontalHeader(ascent=ASCENT, descent=-DESCENT)
builder.setupNameTable({"familyName": "Boxes", "styleName": "Regular"})
builder.setupPost()
everything = {code: "box" for code in range(0x21, 0x30000) if not 0xD800 <= code < 0xE000}
everything |= {code: "space" for code in (0x20, 0xA0, 0x2009, 0x202F)}
cmap = newTable("cmap")
cmap.tableVersion = 0
cmap.tables = [coverage(13, 6, everything)]
builder.font["cmap"] = cmap
builder.setupOS2(sTypoAscender=ASCENT, sTypoDescender=-DESCENT, usWinAscent=ASCENT, usWinDescent=DESCENT)
builder.font.recalcTimestamp = False
builder.save(Path(__file__).parent / "boxes.ttf")
