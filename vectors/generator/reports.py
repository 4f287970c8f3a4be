"""Bytes of the vendor profile's reports (HID-002 … 007, VEC-010).

Implements: VEC-010.
"""

from .numbers import Draws
from .suite import UNKNOWN, Group, is_exact, without

SOURCE = "the byte layout of spec/hid.md, packed by hand"

SETTINGS = """
version position_unit_nm force_unit_un largest_force_mn period_us watchdog_ms damping_mn_s_per_m friction_mn
"""
FORCES, SEQUENCES = [("lateral", "i16"), ("normal", "i16")], [("sequence", "u16"), ("force_sequence", "u16")]
LAYOUT = {
    1: [*FORCES, ("buttons", "u8"), ("status", "u8"), *SEQUENCES],
    2: [*FORCES, ("sequence", "u16"), ("flags", "u8")],
    3: [(name, "u16") for name in SETTINGS.split()],
    4: [("control", "u8")],
}
RANGES = {"i16": (-32768, 32767), "u16": (0, 65535), "u8": (0, 255)}


def encode(report, fields, big=False):
    """The bytes in hexadecimal; negative numbers in two's complement."""
    text = f"{report:02x}"
    for name, kind in LAYOUT[report]:
        size = 1 if kind == "u8" else 2
        raw = [f"{fields[name] % 256**size >> 8 * k & 255:02x}" for k in range(size)]
        text += "".join(reversed(raw) if big else raw)
    return text


def misread(report, fields, how):
    """The fields that a decoder with a bug would read."""
    result = dict(fields)
    for name, kind in LAYOUT[report]:
        value = fields[name] % 65536
        if how == "big_endian" and kind != "u8":
            value = value >> 8 | (value & 255) << 8
            result[name] = value - 65536 if kind == "i16" and value > 32767 else value
        if how == "sign_ignored" and kind == "i16":
            result[name] = value
    if how == "fields_exchanged":
        for a, b in (("lateral", "normal"), ("sequence", "force_sequence"), ("largest_force_mn", "period_us")):
            if a in fields and b in fields:
                result[a], result[b] = fields[b], fields[a]
    return result


def samples(draws):
    """Reports with the ends of each range, and drawn ones."""
    for report, layout in LAYOUT.items():
        if report == 4:
            yield from ((4, {"control": c}, kind) for c, kind in enumerate(("stop", "enable", "clear fault")))
            continue
        yield report, {name: 0 for name, _ in layout}, "zeros"
        yield report, {name: RANGES[kind][1] for name, kind in layout}, "the largest of each"
        yield report, {name: RANGES[kind][0] for name, kind in layout}, "the least of each"
        yield report, {name: (-1 if kind == "i16" else 1) for name, kind in layout}, "minus ones"
        yield report, {name: 0x1234 if kind != "u8" else 0x56 for name, kind in layout}, "bytes that tell the order"
        for _ in range(16 if report < 3 else 10):
            yield report, {name: draws.integer(*RANGES[kind]) for name, kind in layout}, "drawn"


def usable(report, fields):
    """Feature report 3 of version 1 with units: others are data that a session refuses (HID-008), which no requirement on
    bytes decides."""
    if report != 3:
        return fields
    return {
        **fields,
        "version": 1,
        "position_unit_nm": fields["position_unit_nm"] or 1000,
        "force_unit_un": fields["force_unit_un"] or 500,
    }


# Verifies: HID-002, HID-006.
def report_decode():
    names = sorted({"report", *(name for layout in LAYOUT.values() for name, _ in layout)})
    group = Group("report_decode", SOURCE, {name: is_exact("a whole number") for name in names})
    for report, fields, kind in samples(Draws(70)):
        fields = usable(report, fields)
        wrong = [(how, misread(report, fields, how)) for how in ("big_endian", "sign_ignored", "fields_exchanged")]
        group.accept(f"report {report}, {kind}", {"bytes": encode(report, fields)}, {"report": report, **fields}, wrong)
    ones = {report: usable(report, {name: 1 for name, _ in layout}) for report, layout in LAYOUT.items()}
    sample = {report: encode(report, fields) for report, fields in ones.items()}
    for report, text in sample.items():
        group.refuse(f"report {report}, a byte short", {"bytes": text[:-2]}, "length_not_checked")
        group.refuse(f"report {report}, a byte more", {"bytes": text + "00"}, "length_not_checked")
        group.refuse(f"report {report}, its number alone", {"bytes": text[:2]}, "length_not_checked")
    for number in ("00", "05", "ff", "10"):
        group.refuse(f"report number {number}", {"bytes": number + sample[1][2:]}, "value_not_checked")
    for control in ("03", "80", "ff"):
        group.refuse(f"control {control}", {"bytes": "04" + control}, "value_not_checked")
    group.refuse("no bytes", {"bytes": ""}, "empty")
    group.refuse("half a byte", {"bytes": "040"}, "length_not_checked")
    group.refuse("no hexadecimal digits", {"bytes": "04zz"}, "wrong_type")
    group.refuse("a sign among the digits", {"bytes": "04+1"}, "wrong_type")
    group.refuse("not of ASCII", {"bytes": "04é"}, "wrong_type")
    group.refuse("a list of numbers", {"bytes": [4, 1]}, "wrong_type")
    group.refuse("null", {"bytes": None}, "wrong_type")
    group.refuse("missing", {}, "missing_argument")
    group.refuse("an argument that the op does not have", {"bytes": "0401", UNKNOWN: 2}, "unknown_argument")
    group.refuse("a thousand bytes", {"bytes": "01" + "00" * 999}, "length_not_checked")
    return group


# Verifies: HID-002, HID-006.
def report_encode():
    group = Group("report_encode", SOURCE, {"bytes": is_exact("bytes")})
    for report, fields, kind in samples(Draws(71)):
        fields = usable(report, fields)
        text = encode(report, fields)
        wrong = [
            ("big_endian", {"bytes": encode(report, fields, big=True)}),
            ("fields_exchanged", {"bytes": encode(report, misread(report, fields, "fields_exchanged"))}),
            ("number_left_out", {"bytes": text[2:]}),
        ]
        group.accept(f"report {report}, {kind}", {"report": report, **fields}, {"bytes": text}, wrong)
    for report, layout in LAYOUT.items():
        args = {"report": report, **usable(report, {name: 1 for name, _ in layout})}
        name, kind = layout[0]
        low, high = RANGES[kind] if report != 4 else (0, 2)
        group.refuse(f"report {report}: {name} is missing", without(args, name), "missing_argument")
        group.refuse(f"report {report}: {name} above its range", args, "wrapped", **{name: high + 1})
        group.refuse(f"report {report}: {name} below its range", args, "wrapped", **{name: low - 1})
        group.refuse(f"report {report}: {name} is null", args, "wrong_type", **{name: None})
        group.refuse(f"report {report}: {name} is 0.5", args, "wrong_type", **{name: 0.5})
        group.refuse(f"report {report}: {name} is 2⁶⁴", args, "wrapped", **{name: 2**64})
        group.refuse(f"report {report}: a field of no report", args, "unknown_argument", **{UNKNOWN: 1})
    fields = {"lateral": 1, "normal": 1, "sequence": 1, "flags": 1}
    for report in (0, 5, 256 + 2, -1):
        group.refuse(f"report {report}", {"report": report, **fields}, "value_not_checked")
    group.refuse("no report", fields, "missing_argument")
    group.refuse("a report by text", {"report": "2", **fields}, "wrong_type")
    return group


GROUPS = [report_decode, report_encode]
