"""A field is added in at most four places, and then written, read, printed, told and validated."""

from benchmarks.house_field import add_a_field


def test_a_field_is_added_in_four_places():
    assert add_a_field() == [
        "ontology/trace.ttl",
        "runtime/loop/records.py",
        "runtime/trace/narrate.py",
        "runtime/trace/table.py",
    ]
