//! A QEMU plugin that writes the executed blocks to the Unix socket of its argument `socket=PATH`.
//! For each block, which has no branch except at its end: the addresses of its first and last
//! instruction as little-endian 32-bit words.
//!
//! The prototypes are those of QEMU's plugin interface, version 1 (QEMU 4.2 and later; headers
//! are not needed). All state is in one writer behind a lock: an emulated microcontroller has a
//! single core, so the lock is never contended.

use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::io::{BufWriter, Write};
use std::os::unix::net::UnixStream;
use std::sync::Mutex;
use std::time::Duration;

/// The interface version that QEMU checks before it calls anything.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals)] // QEMU looks for this very name
pub static qemu_plugin_version: c_int = 1;

type PluginId = u64;
type Block = c_void;
type Instruction = c_void;

/// `enum qemu_plugin_cb_flags`: the callback reads no registers.
const NO_REGISTERS: c_int = 0;

unsafe extern "C" {
    fn qemu_plugin_register_vcpu_tb_trans_cb(
        id: PluginId,
        callback: extern "C" fn(PluginId, *mut Block),
    );
    fn qemu_plugin_register_atexit_cb(
        id: PluginId,
        callback: extern "C" fn(PluginId, *mut c_void),
        data: *mut c_void,
    );
    fn qemu_plugin_tb_n_insns(block: *const Block) -> usize;
    fn qemu_plugin_tb_get_insn(block: *const Block, index: usize) -> *mut Instruction;
    fn qemu_plugin_insn_vaddr(instruction: *const Instruction) -> u64;
    fn qemu_plugin_register_vcpu_tb_exec_cb(
        block: *mut Block,
        callback: extern "C" fn(c_uint, *mut c_void),
        flags: c_int,
        data: *mut c_void,
    );
}

/// Longest time that a block stays in the buffer.
const FLUSH: Duration = Duration::from_millis(100);

/// Writer of the addresses.
static OUTLET: Mutex<Option<BufWriter<UnixStream>>> = Mutex::new(None);

/// Called by QEMU when it loads the plugin; anything but 0 refuses.
///
/// # Safety
/// `arguments` points to `count` C strings, as QEMU guarantees.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    id: PluginId,
    _info: *const c_void,
    count: c_int,
    arguments: *const *const c_char,
) -> c_int {
    let path = (0..usize::try_from(count).unwrap_or(0)).find_map(|index| {
        // SAFETY: index < count, and QEMU's strings end with a zero.
        let argument = unsafe { CStr::from_ptr(*arguments.add(index)) };
        argument.to_str().ok()?.strip_prefix("socket=").map(str::to_owned)
    });
    let Some(path) = path else {
        eprintln!("trace-plugin: needs socket=PATH");
        return 1;
    };
    let socket = match UnixStream::connect(&path) {
        Ok(socket) => socket,
        Err(error) => {
            eprintln!("trace-plugin: {path}: {error}");
            return 1;
        }
    };
    if let Ok(mut outlet) = OUTLET.lock() {
        *outlet = Some(BufWriter::with_capacity(1 << 16, socket));
    }
    // Flush periodically: a sleeping program does not fill the buffer, and a killed one does not
    // flush it.
    std::thread::spawn(|| {
        loop {
            std::thread::sleep(FLUSH);
            if let Ok(mut outlet) = OUTLET.lock()
                && let Some(writer) = outlet.as_mut()
                && writer.flush().is_err()
            {
                *outlet = None;
            }
        }
    });
    // SAFETY: `id` is the one QEMU gave; the callbacks live as long as the library.
    unsafe {
        qemu_plugin_register_vcpu_tb_trans_cb(id, on_translation);
        qemu_plugin_register_atexit_cb(id, on_exit, std::ptr::null_mut());
    }
    0
}

/// Registers a callback on entry of a block that QEMU has just translated. Blocks end at branches
/// and, once entered, run to their end.
extern "C" fn on_translation(_id: PluginId, block: *mut Block) {
    // SAFETY: `block` and the instructions got from it are valid during this call, and a block
    // has at least one instruction.
    unsafe {
        let address = |index| qemu_plugin_insn_vaddr(qemu_plugin_tb_get_insn(block, index));
        let count = qemu_plugin_tb_n_insns(block);
        let (first, last) = (address(0), address(count - 1));
        // Both addresses are packed into the callback's data pointer: no allocation.
        let data = (first | last << 32) as usize as *mut c_void;
        qemu_plugin_register_vcpu_tb_exec_cb(block, on_execution, NO_REGISTERS, data);
    }
}

const _: () = assert!(size_of::<usize>() == 8, "the callback's data holds two addresses");

/// Writes the addresses of a block that is entered.
extern "C" fn on_execution(_core: c_uint, addresses: *mut c_void) {
    let words = (addresses as u64).to_le_bytes();
    if let Ok(mut outlet) = OUTLET.lock()
        && let Some(writer) = outlet.as_mut()
        && writer.write_all(&words).is_err()
    {
        // The reader has closed the socket: nothing to do.
        *outlet = None;
    }
}

/// Writes what is still buffered.
extern "C" fn on_exit(_id: PluginId, _data: *mut c_void) {
    if let Ok(mut outlet) = OUTLET.lock()
        && let Some(mut writer) = outlet.take()
    {
        let _at_exit_nobody_is_left_to_tell = writer.flush();
    }
}
