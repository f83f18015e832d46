"""Makes the two font files of the page from Arimo: only what characters.txt names, as WOFF2.

    python3 subset.py FOLDER     # the npm package @expo-google-fonts/arimo@0.4.3; fonttools 4.68.0, brotli 1.2.0

The same versions give the same bytes (README.md of the page).
"""

import hashlib
import sys
from pathlib import Path

from fontTools.pens.ttGlyphPen import TTGlyphPen
from fontTools.subset import Options, Subsetter
from fontTools.ttLib import TTFont

HERE = Path(__file__).parent
SOURCES = {
    "Regular": "400Regular/Arimo_400Regular.ttf",
    "SemiBold": "600SemiBold/Arimo_600SemiBold.ttf",
}
# Signs that Arimo lacks and has under another code point: the pointer as play, the letter as diameter.
ALIASES = {0x25B6: 0x25BA, 0x2300: 0x00D8}


def characters():
    """The code points of characters.txt."""
    lines = (HERE / "characters.txt").read_text().splitlines()
    for line in lines:
        if line and not line.startswith("#"):
            first, _, last = line.partition("-")
            yield from range(int(first, 16), int(last or first, 16) + 1)


def add(font, code, advance, corners):
    """Adds a sign made of one polygon; corners run clockwise, in units of the em."""
    em = font["head"].unitsPerEm
    pen = TTGlyphPen(None)
    points = [(round(x * em), round(y * em)) for x, y in corners]
    pen.moveTo(points[0])
    for point in points[1:]:
        pen.lineTo(point)
    pen.closePath()
    name = f"uni{code:04X}"
    font["glyf"][name] = pen.glyph()
    font["hmtx"][name] = (round(advance * em), points[0][0])
    font.setGlyphOrder([*font.getGlyphOrder(), name] if name not in font.getGlyphOrder() else font.getGlyphOrder())
    encode(font, code, name)


def encode(font, code, name):
    for table in font["cmap"].tables:
        if table.isUnicode():
            table.cmap[code] = name


def without_kerned_digits(font):
    """Digits keep one width, so that numbers stand in columns: Arimo draws two ones together."""
    digits = {font.getBestCmap()[ord(digit)] for digit in "0123456789"}
    for lookup in font["GPOS"].table.LookupList.Lookup:
        for subtable in lookup.SubTable:
            subtable = getattr(subtable, "ExtSubTable", subtable)
            if subtable.LookupType != 2:
                continue
            assert subtable.Format == 1, "kerning by classes: digits would have to be taken out of them"
            for first, pairs in zip(subtable.Coverage.glyphs, subtable.PairSet):
                if first in digits:
                    kept = [pair for pair in pairs.PairValueRecord if pair.SecondGlyph not in digits]
                    pairs.PairValueRecord, pairs.PairValueCount = kept, len(kept)


def subset(source, target):
    font = TTFont(source, recalcTimestamp=False)
    for code, same in ALIASES.items():
        encode(font, code, font.getBestCmap()[same])
    add(font, 0x25C6, 0.604, [(0.05, 0.355), (0.302, 0.66), (0.554, 0.355), (0.302, 0.05)])
    add(font, 0x275A, 0.3, [(0.07, 0.0), (0.07, 0.72), (0.23, 0.72), (0.23, 0.0)])
    without_kerned_digits(font)
    wanted = set(characters())
    missing = wanted - font.getBestCmap().keys()
    assert not missing, f"{source} lacks {sorted(map(hex, missing))}"
    options = Options(layout_features=["kern"], hinting=False, flavor="woff2", name_IDs=[0, 1, 2, 13, 14], notdef_outline=True)
    subsetter = Subsetter(options)
    subsetter.populate(unicodes=wanted)
    subsetter.subset(font)
    font.flavor = "woff2"
    font.save(target)
    data = target.read_bytes()
    print(f"{target.name}: {len(data)} bytes, SHA-256 {hashlib.sha256(data).hexdigest()}")


for style, file in SOURCES.items():
    subset(Path(sys.argv[1]) / file, HERE / f"Arimo-{style}-subset.woff2")
