"""What each study found, in a sentence or two."""
from whirl.answer import in_print


def of(study):
    """The sentences of its answer, and why it ended early; empty if there is nothing to say."""
    words = ""
    for said in study.answer.sentences:
        words += (" " if words.endswith(".") else "; " if words else "") + said
    status = in_print(study.status)
    if status not in ("", "completed"):
        words += f" {status[:1].upper()}{status[1:]}." if words.endswith(".") else f"; {status}" if words else status
    return words
