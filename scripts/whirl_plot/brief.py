"""What each study found, in a sentence or two."""


def of(study):
    """The sentences of its answer, and why it ended early; empty if there is nothing to say."""
    words = ""
    for said in study.answer.sentences:
        words += (" " if words.endswith(".") else "; " if words else "") + said
    if study.status not in ("", "completed"):
        words += f" {study.status[:1].upper()}{study.status[1:]}." if words.endswith(".") else f"; {study.status}" if words else study.status
    return words
