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


# Verifies: ORA-008, ORA-001, ORA-009.
def requests():
    group = Group("requests", "spec/oracle.md", {}, op="")
    good = '"op":"two_afc","args":{"gamma":1}'
    no_json = {
        "an open object": '{"id":"ID",' + good,
        "an open text": '{"id":"ID","op":"two_a',
        "a comma too many": '{"id":"ID",' + good + ",}",
        "text without quotes": "{id:1," + good + "}",
        "single quotes": "{'id':1,'op':'two_afc','args':{'gamma':1}}",
        "two values": '{"id":"ID",' + good + "} {}",
        "words": "two_afc gamma=1",
        "a comment": '{"id":"ID",/* γ */' + good + "}",
        "a closing bracket": "]",
        "an open bracket": "[",
        "a colon": '{"id" "ID",' + good + "}",
        "a leading zero": '{"id":01,' + good + "}",
        "a leading plus": '{"id":"ID","op":"two_afc","args":{"gamma":+1}}',
        "a hexadecimal number": '{"id":"ID","op":"two_afc","args":{"gamma":0x1}}',
        "a number that ends with its point": '{"id":"ID","op":"two_afc","args":{"gamma":1.}}',
        "a number that begins with its point": '{"id":"ID","op":"two_afc","args":{"gamma":.5}}',
        "an unknown escape": '{"id":"ID","op":"two\\x5fafc","args":{"gamma":1}}',
        "a half escape": '{"id":"ID","op":"\\u12","args":{}}',
        "a control character in a text": '{"id":"ID","op":"two\tafc","args":{}}',
        "True": '{"id":"ID","op":"two_afc","args":{"gamma":True}}',
        "undefined": '{"id":"ID","op":"two_afc","args":{"gamma":undefined}}',
        "NaN alone": "NaN",
        "XML": "<request op='two_afc'/>",
        "a form": "op=two_afc&gamma=1",
    }
    for comment, line in no_json.items():
        group.raw(comment, line, "bad_json", "no_request", MEANT.get(comment))
    not_finite = {
        "NaN": '{"id":"ID","op":"two_afc","args":{"gamma":NaN}}',
        "−NaN": '{"id":"ID","op":"two_afc","args":{"gamma":-NaN}}',
        "Infinity": '{"id":"ID","op":"two_afc","args":{"gamma":Infinity}}',
        "inf": '{"id":"ID","op":"two_afc","args":{"gamma":inf}}',
        "NaN as id": '{"id":NaN,' + good + "}",
    }
    for comment, line in not_finite.items():
        group.raw(comment, line, "bad_json", "not_finite")
    no_request = {
        "null": "null",
        "a number": "1",
        "a text": '"two_afc"',
        "true": "true",
        "an empty list": "[]",
        "an empty object": "{}",
        "a list of requests": '[{"id":"ID",' + good + "}]",
        "no id": "{" + good + "}",
        "id null": '{"id":null,' + good + "}",
        "id true": '{"id":true,' + good + "}",
        "id a list": '{"id":[1],' + good + "}",
        "id an object": '{"id":{},' + good + "}",
        "no op": '{"id":"ID","args":{"gamma":1}}',
        "op null": '{"id":"ID","op":null,"args":{"gamma":1}}',
        "op a number": '{"id":"ID","op":1,"args":{"gamma":1}}',
        "half a surrogate in the op": '{"id":"ID","op":"two_afc\\ud800","args":{"gamma":1}}',
        "surrogates in the wrong order": '{"id":"ID","op":"\\udc00\\ud800","args":{}}',
        "another key": '{"id":"ID",' + good + ',"version":2}',
        "the op twice": '{"id":"ID","op":"normal_cdf",' + good + "}",
        "args twice": '{"id":"ID","args":{"gamma":2},' + good + "}",
        "the id twice": '{"id":"ID","id":2,' + good + "}",
        "op a list": '{"id":"ID","op":["two_afc"],"args":{"gamma":1}}',
    }
    for comment, line in no_request.items():
        group.raw(comment, line, "bad_request", "no_request", MEANT.get(comment))
    unknown = {
        "no such op": '{"id":"ID","op":"three_afc","args":{"gamma":1}}',
        "an empty op": '{"id":"ID","op":"","args":{}}',
        "another case": '{"id":"ID","op":"Two_AFC","args":{"gamma":1}}',
        "spaces around it": '{"id":"ID","op":" two_afc ","args":{"gamma":1}}',
        "a longer one": '{"id":"ID","op":"two_afc_","args":{"gamma":1}}',
        "a very long one": '{"id":"ID","op":"' + "a" * 2000 + '","args":{}}',
        "not of ASCII": '{"id":"ID","op":"θ","args":{}}',
        "a zero character": '{"id":"ID","op":"two_afc\\u0000","args":{"gamma":1}}',
    }
    for comment, line in unknown.items():
        group.raw(comment, line, "unknown_op", "unknown_op")
    arguments = {
        "args a list": '{"id":"ID","op":"two_afc","args":[1]}',
        "args a number": '{"id":"ID","op":"two_afc","args":1}',
        "args null": '{"id":"ID","op":"two_afc","args":null}',
        "args a text": '{"id":"ID","op":"two_afc","args":"gamma=1"}',
        "no args": '{"id":"ID","op":"two_afc"}',
        "empty args": '{"id":"ID","op":"two_afc","args":{}}',
        "an argument that is an object": '{"id":"ID","op":"two_afc","args":{"gamma":{"value":1}}}',
        "an argument twice": '{"id":"ID","op":"two_afc","args":{"gamma":1,"gamma":2}}',
        "an argument of another case": '{"id":"ID","op":"two_afc","args":{"Gamma":1}}',
    }
    for comment, line in arguments.items():
        group.raw(comment, line, "bad_argument", "wrong_type")
    too_large = {
        "1e400": "1e400",
        "a number of 400 digits": "9" * 400,
        "an exponent of 20 digits": "1e99999999999999999999",
    }
    for comment, number in too_large.items():
        line = '{"id":"ID","op":"two_afc","args":{"gamma":' + number + "}}"
        group.raw(comment, line, "bad_argument", "not_finite")
    for depth in (200, 1000, 20000):
        group.raw(f"{depth} lists in each other", "[" * depth + "]" * depth, "bad_request", "deep_nesting")
        group.raw(f"{depth} lists left open", "[" * depth, "bad_json", "deep_nesting")
    group.raw(
        "300 objects in each other",
        '{"id":"ID","op":"two_afc","args":' + '{"a":' * 300 + "1" + "}" * 300 + "}",
        "bad_argument",
        "deep_nesting",
    )
    group.raw(
        "300 lists as an argument",
        '{"id":"ID","op":"two_afc","args":{"gamma":' + "[" * 300 + "]" * 300 + "}}",
        "bad_argument",
        "deep_nesting",
    )
    return group


GROUPS = [requests]
