"""Which language a text is in; themes in others than English are refused by their names."""

from __future__ import annotations

import pytest
from for_each import for_each

from planner_service.themes.beats import ThemeError, beats_of
from planner_service.themes.language import ANOTHER, ENGLISH, language_of, languages

THEMES = {
    "German": "Sie kommt nach Hause, setzt sich auf das Sofa und liest ein Buch.",
    "French": "Elle rentre chez elle, s'assoit sur le canapé et lit un livre.",
    "Spanish": "Ella llega a casa, se sienta en el sofá y lee un libro.",
    "Italian": "Lei torna a casa, si siede sul divano e legge un libro.",
    "Portuguese": "Ela chega em casa, senta-se no sofá e lê um livro.",
    "Dutch": "Zij komt thuis, gaat op de bank zitten en leest een boek.",
    "Swedish": "Hon kommer hem, sätter sig i soffan och läser en bok.",
    "Danish": "Hun kommer hjem, sætter sig op i sofaen og læser en bog.",
    "Norwegian": "Hun kommer hjem, setter seg opp i sofaen og leser en bok.",
    "Finnish": "Hän tulee kotiin, istuu sohvalle ja lukee kirjaa.",
    "Polish": "Ona wraca do domu, siada na kanapie i czyta książkę.",
    "Czech": "Ona přijde domů, posadí se na pohovku a čte si.",
    "Hungarian": "Majd haza megy, leül egy székre és olvas.",
    "Romanian": "Ea vine acasă, se așează pe canapea și citește o carte.",
    "Turkish": "Eve gelir, kanepeye oturur ve bir kitap okur.",
    "Indonesian": "Dia pulang ke rumah, duduk di sofa dan membaca buku.",
    "Russian": "Она приходит домой, садится на диван и читает книгу.",
    "Greek": "Γυρίζει σπίτι, κάθεται στον καναπέ και διαβάζει.",
    "Arabic": "تعود إلى المنزل وتجلس على الأريكة وتقرأ كتابا.",
    "Hindi": "वह घर आती है और किताब पढ़ती है।",
    "Thai": "เธอกลับบ้านและอ่านหนังสือ",
    "Korean": "그녀는 집에 와서 책을 읽는다.",
    "Japanese": "彼女は家に帰り、ソファに座って本を読む。",
    "Chinese": "她回到家，坐在沙发上看书。",
}


@for_each("language", list(THEMES))
def test_a_theme_in_another_language_is_refused_by_its_name(language: str) -> None:
    with pytest.raises(ThemeError, match=f"looks like {language}.* Themes are read in English"):
        beats_of(THEMES[language])


def test_every_language_that_is_known_is_tried() -> None:
    names = {ENGLISH, *(name.split()[0] for name in THEMES)}
    known = languages()
    assert {name.split()[0] for name in (*known.common, *known.letters.values())} <= {*names, "Hebrew"}


@for_each(
    "theme",
    [
        "She goes to la la land.", "He is in the den on his own.", "A splitting headache after last night's boozing.",
        "Teen gamer. Flops in lazy sofa. Plays. Loses. Controller thrown. Arms crossed. Sulks. Phone rings. Bed.",
    ],
)  # fmt: skip
def test_terse_and_odd_english_is_english(theme: str) -> None:
    assert beats_of(theme)


@for_each(
    ("text", "language"),
    [
        ("She came into the room and sat down on the sofa, for she was very tired.", ENGLISH),
        ("Elle entre dans le salon et se laisse tomber sur le canapé, car elle est très fatiguée.", "French"),
        ("She sat down.", ENGLISH),
        ("lorem ipsum dolor sit amet consectetur adipiscing elit sed do eiusmod tempor " * 3, ANOTHER),
        ("", ENGLISH),
    ],
)
def test_the_language_of_a_text_is_told_by_common_words_and_is_english_when_in_doubt(text: str, language: str) -> None:
    assert language_of(text) == language


@for_each(
    "theme", ["The dog sleeps, let's be honest, and she sits.", "The cat died, as there's been a fire, and he weeps."]
)
def test_an_apostrophe_alone_is_nobody(theme: str) -> None:
    assert beats_of(theme)
