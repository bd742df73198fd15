"""Texts that tests extract from, written for them."""

NARRATIVE = """Chapter One

Martha woke before the alarm. She lay for a while with her eyes open, and then she got out of bed and walked to the
wardrobe. She chose the blue dress, the one she had worn to every important meeting of her life.

In the kitchen she poured herself a cup of coffee and sat down at the table. "You will be late," said her brother, but
she was too nervous to answer. She read the letter again, slowly.

It was nine o'clock when the phone rang. Martha hurried into the study and grabbed the phone from the desk. Nobody spoke
at the other end. She paced up and down, worried, and then sank into the chair.

The weather was dreadful all day. Clouds hung over the town and nothing moved in the streets.

At last the good news came. She had got the job! She danced through the living room, laughing, and threw herself onto
the sofa. Her brother opened a bottle of wine, and they drank to her luck.

Later that night she staggered to the bookcase, drunk, and looked for the old album. The pictures of her dead mother
were still in it. She cried and buried her face in her hands.

***

Tired and cold, she finally went to bed. She tossed and turned until the morning.

On Sunday she did nothing at all. She relaxed in the armchair, read a novel and watched the rain through the window.
"""

SCREENPLAY = """FADE IN:

INT. LIVING ROOM - NIGHT

The room is dark. ANNA (30s) comes in, drops her keys in a bowl and slumps onto the COUCH. She stares at the ceiling.

ANNA
(sighing)
I can't do this anymore. I am so tired.

She grabs the PHONE from the SHELF and paces up and down. The phone RINGS.

TOM (V.O.)
Where are you?

ANNA
(sinks into the armchair)
Home. Don't be angry with me.

CUT TO:

EXT. STREET - NIGHT

Tom runs through the rain.

INT. BEDROOM - LATER

Anna lies awake in bed. She gets up, opens the wardrobe and takes out a coat.
"""

SUBTITLES = """1
00:00:01,000 --> 00:00:03,000
ANNA: I am so angry with you!

2
00:00:04,000 --> 00:00:06,000
She storms through the room

3
00:00:06,500 --> 00:00:08,000
and sits down on the sofa.

4
00:01:10,000 --> 00:01:12,000
Do you remember the summer?

5
00:01:30,000 --> 00:01:33,000
[he lies down on the bed]
"""

GERMAN = """Der Mann ging langsam in das Zimmer und setzte sich auf das Sofa. Er war sehr müde, und nach einer Weile
schlief er ein."""
