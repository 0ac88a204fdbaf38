"""Formatting keeps the task and every comment, puts each beside what it stood beside, and is done once."""

from __future__ import annotations

import random
import re

import pytest

from onto_compiler.bddl import format_task, parse
from onto_compiler.bddl.layout import format_text
from onto_compiler.command import CLEAN, FINDINGS, MISUSE
from onto_compiler.problems import OntoError
from runtime.cli import main

LOOSE = """; who wrote this
(define (problem P) ; the engine's class
(:domain robosuite)
; how a person says it
(:language   put the  bowl away) ; short
(:fixtures main_table - table)
(:objects ; two of them
  bowl_1 - bowl ; the black one
  ; the round one
  plate_1 - plate
  ; no more
)
(:init (On bowl_1 main_table_r) ; near
  (On plate_1
    main_table_r)
)
; what shall be
(:goal (And (On bowl_1 plate_1) ; done
  ; and nothing else
))
; the last word
)
; after all
"""
TIDY = """; who wrote this
(define (problem P)  ; the engine's class
  (:domain robosuite)

  ; how a person says it
  (:language put the bowl away)  ; short

  (:fixtures
    main_table - table
  )

  (:objects  ; two of them
    bowl_1 - bowl  ; the black one
    ; the round one
    plate_1 - plate
  ; no more
  )

  (:init
    (On bowl_1 main_table_r)  ; near
    (On plate_1 main_table_r)
  )

  ; what shall be
  (:goal
    (And (On bowl_1 plate_1))  ; done
  ; and nothing else
  )
; the last word
)
; after all
"""


def comments(text):
    return sorted(re.findall(r";.*", text))


def test_comments_stay_beside_what_they_stood_beside():
    assert format_text(LOOSE) == TIDY
    assert format_text(TIDY) == TIDY


def test_without_comments_the_layout_is_the_printers(task_file):
    text = task_file.read_text("utf-8")
    assert format_text(text) == format_task(parse(text))


@pytest.mark.parametrize("seed", range(30))
def test_comments_anywhere_are_kept_and_formatting_twice_is_formatting_once(seed, task_file):
    rng = random.Random(seed)  # noqa: S311 - places need no secrecy
    text = task_file.read_text("utf-8")
    places = [match.end() for match in re.finditer(r"[()]|\s+|[^\s()]+", text)]
    for number, place in enumerate(sorted(rng.sample(places, 8), reverse=True)):
        text = f"{text[:place]} ; remark {number} (\n{text[place:]}"
    once = format_text(text)
    assert parse(once) == parse(text)
    assert comments(once) == comments(text)
    assert len(comments(once)) == 8
    assert format_text(once) == once


def test_what_readers_pass_over_is_not_dropped_in_silence():
    text = "(define (problem P) (:domain omnigibson) (:init) (:goal (on a b) (not (open a))))"
    with pytest.raises(OntoError, match=r"BDDL032: .*so formatting would drop it"):
        format_text(text)


def test_the_command_formats_checks_and_shows(tmp_path, capsys, task_file):
    loose, tidy = tmp_path / "sub" / "loose.bddl", tmp_path / "tidy.bddl"
    loose.parent.mkdir()
    loose.write_text(LOOSE, "utf-8")
    tidy.write_text(format_text(LOOSE), "utf-8")
    assert main(["fmt", "--check", str(tmp_path)]) == FINDINGS
    captured = capsys.readouterr()
    assert captured.out == f"{loose}\n"
    assert captured.err == "1 of 2 files would change\n"
    assert main(["fmt", "--diff", str(loose)]) == FINDINGS
    assert "\n-(:language   put the  bowl away) ; short\n" in capsys.readouterr().out
    assert loose.read_text("utf-8") == LOOSE
    assert main(["fmt", str(tmp_path)]) == CLEAN
    assert loose.read_text("utf-8") == tidy.read_text("utf-8")
    assert main(["fmt", "--check", str(tmp_path)]) == CLEAN


def test_a_broken_file_is_a_finding_and_another_kind_of_file_is_misuse(tmp_path, capsys):
    broken = tmp_path / "broken.bddl"
    broken.write_text("(define (problem P)", "utf-8")
    assert main(["fmt", str(broken)]) == FINDINGS
    assert "BDDL002" in capsys.readouterr().err
    assert broken.read_text("utf-8") == "(define (problem P)"
    assert main(["fmt", str(tmp_path / "none.bddl")]) == FINDINGS
    assert "BDDL004" in capsys.readouterr().err
    assert main(["fmt", str(tmp_path / "x.txt")]) == MISUSE
