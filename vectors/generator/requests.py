"""Lines that no op owns: all must be answered by an error, and the program goes on (spec/oracle.md)."""

from mpmath import sqrt

from .normal import cdf
from .suite import Group

ONE, HALF = ({"p_correct": cdf(gamma / sqrt(2))} for gamma in (1, 0.5))
MEANT = {
    "a comma too many": ONE,
    "a comment": ONE,
    "a leading plus": ONE,
    "a hexadecimal number": ONE,
    "a number that ends with its point": ONE,
    "a number that begins with its point": HALF,
    "another key": ONE,
}
"""What two_afc answers to lines that are right in a looser JSON, or but for a key.

Implements: VEC-006.
"""


GOOD = '"op":"two_afc","args":{"gamma":1}'


def asked(args):
    return '{"id":"ID","op":"two_afc","args":' + args + "}"


LINES = {
    ("bad_json", "no_request"): {
        "an open object": '{"id":"ID",' + GOOD,
        "an open text": '{"id":"ID","op":"two_a',
        "a comma too many": '{"id":"ID",' + GOOD + ",}",
        "text without quotes": "{id:1," + GOOD + "}",
        "single quotes": "{'id':1,'op':'two_afc','args':{'gamma':1}}",
        "two values": '{"id":"ID",' + GOOD + "} {}",
        "words": "two_afc gamma=1",
        "a comment": '{"id":"ID",/* γ */' + GOOD + "}",
        "a closing bracket": "]",
        "an open bracket": "[",
        "a colon": '{"id" "ID",' + GOOD + "}",
        "a leading zero": '{"id":01,' + GOOD + "}",
        "a leading plus": asked('{"gamma":+1}'),
        "a hexadecimal number": asked('{"gamma":0x1}'),
        "a number that ends with its point": asked('{"gamma":1.}'),
        "a number that begins with its point": asked('{"gamma":.5}'),
        "an unknown escape": '{"id":"ID","op":"two\\x5fafc","args":{"gamma":1}}',
        "a half escape": '{"id":"ID","op":"\\u12","args":{}}',
        "a control character in a text": '{"id":"ID","op":"two\tafc","args":{}}',
        "True": asked('{"gamma":True}'),
        "undefined": asked('{"gamma":undefined}'),
        "NaN alone": "NaN",
        "XML": "<request op='two_afc'/>",
        "a form": "op=two_afc&gamma=1",
    },
    ("bad_json", "not_finite"): {
        "NaN": asked('{"gamma":NaN}'),
        "−NaN": asked('{"gamma":-NaN}'),
        "Infinity": asked('{"gamma":Infinity}'),
        "inf": asked('{"gamma":inf}'),
        "NaN as id": '{"id":NaN,' + GOOD + "}",
    },
    ("bad_request", "no_request"): {
        "null": "null",
        "a number": "1",
        "a text": '"two_afc"',
        "true": "true",
        "an empty list": "[]",
        "an empty object": "{}",
        "a list of requests": '[{"id":"ID",' + GOOD + "}]",
        "no id": "{" + GOOD + "}",
        "id null": '{"id":null,' + GOOD + "}",
        "id true": '{"id":true,' + GOOD + "}",
        "id a list": '{"id":[1],' + GOOD + "}",
        "id an object": '{"id":{},' + GOOD + "}",
        "no op": '{"id":"ID","args":{"gamma":1}}',
        "op null": '{"id":"ID","op":null,"args":{"gamma":1}}',
        "op a number": '{"id":"ID","op":1,"args":{"gamma":1}}',
        "half a surrogate in the op": '{"id":"ID","op":"two_afc\\ud800","args":{"gamma":1}}',
        "surrogates in the wrong order": '{"id":"ID","op":"\\udc00\\ud800","args":{}}',
        "another key": '{"id":"ID",' + GOOD + ',"version":2}',
        "the op twice": '{"id":"ID","op":"normal_cdf",' + GOOD + "}",
        "args twice": '{"id":"ID","args":{"gamma":2},' + GOOD + "}",
        "the id twice": '{"id":"ID","id":2,' + GOOD + "}",
        "op a list": '{"id":"ID","op":["two_afc"],"args":{"gamma":1}}',
    },
    ("unknown_op", "unknown_op"): {
        "no such op": '{"id":"ID","op":"three_afc","args":{"gamma":1}}',
        "an empty op": '{"id":"ID","op":"","args":{}}',
        "another case": '{"id":"ID","op":"Two_AFC","args":{"gamma":1}}',
        "spaces around it": '{"id":"ID","op":" two_afc ","args":{"gamma":1}}',
        "a longer one": '{"id":"ID","op":"two_afc_","args":{"gamma":1}}',
        "a very long one": '{"id":"ID","op":"' + "a" * 2000 + '","args":{}}',
        "not of ASCII": '{"id":"ID","op":"θ","args":{}}',
        "a zero character": '{"id":"ID","op":"two_afc\\u0000","args":{"gamma":1}}',
    },
    ("bad_argument", "wrong_type"): {
        "args a list": asked("[1]"),
        "args a number": asked("1"),
        "args null": asked("null"),
        "args a text": asked('"gamma=1"'),
        "no args": '{"id":"ID","op":"two_afc"}',
        "empty args": asked("{}"),
        "an argument that is an object": asked('{"gamma":{"value":1}}'),
        "an argument twice": asked('{"gamma":1,"gamma":2}'),
        "an argument of another case": asked('{"Gamma":1}'),
    },
    ("bad_argument", "not_finite"): {
        "1e400": asked('{"gamma":1e400}'),
        "a number of 400 digits": asked('{"gamma":' + "9" * 400 + "}"),
        "an exponent of 20 digits": asked('{"gamma":1e99999999999999999999}'),
    },
}
"""Lines by the error and the flag, each with its comment."""


# Verifies: ORA-008, ORA-001, ORA-009.
def requests():
    group = Group("requests", "spec/oracle.md", {}, op="")
    for (error, flag), lines in LINES.items():
        for comment, line in lines.items():
            group.raw(comment, line, error, flag, MEANT.get(comment))
    for depth in (200, 1000, 20000):
        group.raw(f"{depth} lists in each other", "[" * depth + "]" * depth, "bad_request", "deep_nesting")
        group.raw(f"{depth} lists left open", "[" * depth, "bad_json", "deep_nesting")
    objects, lists = '{"a":' * 300 + "1" + "}" * 300, '{"gamma":' + "[" * 300 + "]" * 300 + "}"
    group.raw("300 objects in each other", asked(objects), "bad_argument", "deep_nesting")
    group.raw("300 lists as an argument", asked(lists), "bad_argument", "deep_nesting")
    return group


GROUPS = [requests]
