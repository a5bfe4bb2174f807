/* SPDX-License-Identifier: MIT */
/*
 * The viewer of the report. Its pictures are strips: those of the truth one
 * below the other, and of each method how far each picture is above another one
 * (`bases`: of which strip, which, and where the differences are), then how far
 * below. Only drawing modes put them together, which are exact in 8 bits; no
 * pixel is ever read, which some browsers falsify. What is chosen is decoded,
 * nothing before.
 */
'use strict';
(function () {
	const works = JSON.parse(document.getElementById('viewer-data').textContent);
	const at = (name) => document.getElementById('viewer-' + name);
	const viewer = at('picture').closest('section');
	const canvas = at('picture');
	const context = canvas.getContext('2d', {alpha: false});
	const side = document.createElement('canvas');
	const sideContext = side.getContext('2d', {alpha: false});
	const TRUTH = 'truth';
	const PLAY_MS = 500;
	const HEIGHT_SHARE = 0.62; /* of the window, so that the controls are seen with the picture */
	let images = {};
	let timer = 0;

	const work = () => works[at('scene').selectedIndex];
	const method = (name) => work().methods.find((one) => one.name === name);

	function fill(select, names, wanted) {
		const before = select.value;
		select.replaceChildren(...names.map((name) => new Option(name)));
		select.value = names.includes(before) ? before : wanted;
	}

	/* The picture of an address or an element of the page, decoded; null where there is none. */
	async function load(source) {
		if (!source)
			return null;
		if (!images[source]) {
			const image = new Image();
			image.src = source;
			images[source] = image.decode().then(() => image);
		}
		return images[source];
	}

	function seenBy(name) {
		const image = document.getElementById(work().seen + name);
		return image ? image.src : '';
	}

	function drawStrip(mode, strip, index) {
		sideContext.globalCompositeOperation = mode;
		sideContext.drawImage(strip, 0, -index * side.height);
	}

	/* As it is displayed; strip 0 is the truth, the others are methods. */
	async function drawDisplayed(strip, frame) {
		if (strip === 0)
			return drawStrip('source-over', await load(work().truth), frame);
		const one = work().methods[strip - 1], [base, picture, differences] = one.bases[frame];
		const own = await load(one.strip);
		if (base >= 0)
			await drawDisplayed(base, picture);
		if (own && differences >= 0) {
			drawStrip('lighter', own, differences);
			drawStrip('difference', own, one.differing + differences);
		}
	}

	/* Draws the picture of one method into `side`. */
	async function drawSide(name, show, frame) {
		sideContext.globalCompositeOperation = 'source-over';
		sideContext.fillStyle = '#000';
		sideContext.fillRect(0, 0, side.width, side.height);
		if (show === 'seen') {
			const seen = await load(seenBy(name));
			if (seen)
				sideContext.drawImage(seen, 0, 0);
			return;
		}
		await drawDisplayed(name === TRUTH ? 0 : 1 + work().methods.indexOf(method(name)), frame);
		if (show === 'displayed')
			return;
		drawStrip('difference', await load(work().truth), frame);
		sideContext.globalCompositeOperation = 'lighter';
		for (let factor = Number(show); factor > 1; factor /= 2)
			sideContext.drawImage(side, 0, 0);
	}

	function describe(name) {
		const late = name === TRUTH ? 0 : method(name).late;
		return late ? name + ' (one frame late)' : name;
	}

	function status(show, frame) {
		const picture = work().pictures[frame];
		const names = at('left').value + ' | ' + at('right').value;
		if (show === 'seen')
			return names + ', as an eye sees them that follows the motion';
		return 'picture ' + (frame + 1) + ' of ' + work().pictures.length + ', ' + picture.kind + ', ' +
			picture.time.toFixed(4) + ' s: ' + names;
	}

	async function draw() {
		const show = at('show').value, frame = Number(at('frame').value), split = Number(at('split').value) / 100;
		const edge = Math.round(split * canvas.width);
		const text = status(show, frame);
		for (const [name, left, width] of [['left', 0, edge], ['right', edge, canvas.width - edge]]) {
			await drawSide(at(name).value, show, frame);
			if (width > 0)
				context.drawImage(side, left, 0, width, side.height, left, 0, width, side.height);
			viewer.querySelector('.side.' + name).textContent = describe(at(name).value);
		}
		viewer.querySelector('.edge').style.left = 100 * split + '%';
		at('split').setAttribute('aria-valuetext', at('split').value + ' % ' + at('left').value);
		at('frame').setAttribute('aria-valuetext', text);
		canvas.setAttribute('aria-label', work().name);
		at('status').textContent = text;
		viewer.dataset.shown = [work().name, at('left').value, at('right').value, show, frame, edge].join(';');
	}

	/* One drawing at a time; what changed meanwhile is drawn after it. */
	let drawing = null, again = false;
	function update() {
		viewer.setAttribute('aria-busy', 'true');
		if (drawing) {
			again = true;
			return;
		}
		drawing = draw().catch((problem) => console.error(problem)).then(() => {
			drawing = null;
			if (again) {
				again = false;
				update();
			} else {
				viewer.removeAttribute('aria-busy');
			}
		});
	}

	function chooseShow() {
		const seen = at('show').value === 'seen';
		for (const name of ['frame', 'previous', 'next', 'play'])
			at(name).disabled = seen;
		if (seen)
			play(false);
		update();
	}

	function chooseScene() {
		const names = [TRUTH, ...work().methods.map((one) => one.name)];
		const eye = at('show').querySelector('[value=seen]');
		images = {};
		fill(at('left'), names, names.includes('hold') ? 'hold' : names[1] || TRUTH);
		fill(at('right'), names, names.includes('pursuit') ? 'pursuit' : names[names.length - 1]);
		canvas.width = side.width = work().width;
		canvas.height = side.height = work().height;
		canvas.style.width = 'min(' + Math.max(1, Math.floor(1200 / canvas.width)) * canvas.width + 'px, ' +
			100 * HEIGHT_SHARE * canvas.width / canvas.height + 'vh)';
		at('frame').max = work().pictures.length - 1;
		at('frame').value = Math.max(0, work().pictures.findIndex((one) => one.kind !== 'real frame'));
		eye.disabled = !seenBy(TRUTH);
		if (eye.disabled && eye.selected)
			at('show').value = 'displayed';
		chooseShow();
	}

	function step(by) {
		const count = work().pictures.length;
		at('frame').value = (Number(at('frame').value) + by + count) % count;
		update();
	}

	function play(on) {
		clearInterval(timer);
		timer = on ? setInterval(() => step(1), PLAY_MS) : 0;
		at('play').setAttribute('aria-pressed', String(on));
		at('play').textContent = on ? 'Stop' : 'Play';
		at('status').setAttribute('aria-live', on ? 'off' : 'polite');
	}

	function drag(event) {
		const box = canvas.getBoundingClientRect();
		at('split').value = 100 * (event.clientX - box.left) / box.width;
		update();
	}

	if (works.length === 0) {
		viewer.hidden = true;
		return;
	}
	at('scene').replaceChildren(...works.map((one) => new Option(one.name)));
	at('scene').addEventListener('change', chooseScene);
	at('show').addEventListener('change', chooseShow);
	for (const name of ['left', 'right'])
		at(name).addEventListener('change', update);
	for (const name of ['split', 'frame'])
		at(name).addEventListener('input', update);
	at('previous').addEventListener('click', () => step(-1));
	at('next').addEventListener('click', () => step(1));
	at('play').addEventListener('click', () => play(!timer));
	canvas.addEventListener('pointerdown', (event) => {
		canvas.setPointerCapture(event.pointerId);
		drag(event);
	});
	canvas.addEventListener('pointermove', (event) => {
		if (event.buttons)
			drag(event);
	});
	viewer.addEventListener('keydown', (event) => {
		if (event.target.tagName === 'SELECT' || at('frame').disabled || event.ctrlKey || event.altKey || event.metaKey)
			return;
		if (event.key === ',' || event.key === '.')
			step(event.key === '.' ? 1 : -1);
	});
	viewer.querySelector('.panel').hidden = false;
	chooseScene();
}());
