"""XLSX workbooks as spreadsheet programs write them, of cells given as XML or as values."""

import io
import zipfile
from collections.abc import Iterable, Mapping

MAIN = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
_OFFICE = "http://schemas.openxmlformats.org/officeDocument/2006/relationships"
_PACKAGE = "http://schemas.openxmlformats.org/package/2006"
_KIND = f'Type="{_OFFICE}/worksheet"'
# Formats of cells: 1 a date, 2 a time of day, 3 a duration.
_STYLES = (
    f'<styleSheet {MAIN}><numFmts count="1"><numFmt numFmtId="164" formatCode="[h]:mm:ss.000"/></numFmts>'
    '<cellXfs><xf numFmtId="0"/><xf numFmtId="14"/><xf numFmtId="21"/><xf numFmtId="164"/></cellXfs>'
    "</styleSheet>"
)


def zipped(members: Mapping[str, str | bytes]) -> bytes:
    """Return an archive of these members."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return target.getvalue()


def workbook(sheet: str, shared: str = "", **extra: bytes) -> bytes:
    """Return a workbook whose first sheet is of this XML."""
    parts = {
        "[Content_Types].xml": f'<Types xmlns="{_PACKAGE}/content-types"/>',
        "_rels/.rels": f'<Relationships xmlns="{_PACKAGE}/relationships"><Relationship Id="rId1" '
        f'Type="{_OFFICE}/officeDocument" Target="xl/workbook.xml"/></Relationships>',
        "xl/workbook.xml": f'<workbook {MAIN} xmlns:r="{_OFFICE}"><sheets><sheet name="A" sheetId="1" '
        'r:id="rId7"/><sheet name="B" sheetId="2" r:id="rId1"/></sheets></workbook>',
        "xl/_rels/workbook.xml.rels": f'<Relationships xmlns="{_PACKAGE}/relationships">'
        f'<Relationship Id="rId1" {_KIND} Target="worksheets/sheet2.xml"/>'
        f'<Relationship Id="rId7" {_KIND} Target="worksheets/sheet1.xml"/></Relationships>',
        "xl/worksheets/sheet1.xml": sheet,
        "xl/sharedStrings.xml": f"<sst {MAIN}>{shared}</sst>",
        "xl/styles.xml": _STYLES,
    }
    return zipped(parts | extra)


def sheet_xml(rows: Iterable[Iterable[object]], style: int = 0) -> str:
    """Return a sheet of texts and numbers, the latter in a format of cells."""
    lines = "".join(f"<row>{''.join(_cell(value, style) for value in row)}</row>" for row in rows)
    return f'<?xml version="1.0"?><worksheet {MAIN}><sheetData>{lines}</sheetData></worksheet>'


def _cell(value: object, style: int) -> str:
    if isinstance(value, str):
        return f'<c t="inlineStr"><is><t>{value}</t></is></c>'
    return f'<c s="{style}"><v>{value!r}</v></c>'
