"""Judging: a robot and what is expected of it -> what is met, and what not."""

from __future__ import annotations

from kinetostat.policy.judging.judge import judge, unjudged

__all__ = ["judge", "unjudged"]
